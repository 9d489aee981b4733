#include "ros/unknown_parameters.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <sstream>
#include <utility>

namespace cbmv {
namespace {

/// Read by diagnostic_updater, and by a nodelet manager with the same name as its nodelet (nodelet
/// standalone).
constexpr std::array<const char*, 2> kOfLibraries = {"diagnostic_period", "num_worker_threads"};

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() +
                               1);  // distances from the current prefix of a to all prefixes of b
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// Names directly below the namespace; deeper names belong to libraries (image transports).
std::vector<std::string> namesBelow(const ros::NodeHandle& private_nh) {
  const std::string prefix = private_nh.getNamespace() + "/";
  std::vector<std::string> all;
  private_nh.getParamNames(all);
  std::vector<std::string> names;
  for (const std::string& name : all) {
    if (name.rfind(prefix, 0) == 0 && name.find('/', prefix.size()) == std::string::npos) {
      names.push_back(name.substr(prefix.size()));
    }
  }
  return names;
}

template <typename Names>
bool holds(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

std::string parameterAdvice(const std::string& name, const std::string& parameter) {
  const std::string what =
      name == parameter ? "It is a parameter." : "Did you mean the parameter " + parameter + "?";
  return what +
         " Set it as a private parameter of the node, in a preset, or with dynamic_reconfigure";
}

}  // namespace

std::string nearestName(const std::string& name, const std::vector<std::string>& names) {
  return *std::min_element(names.begin(), names.end(),
                           [&](const std::string& a, const std::string& b) {
                             return editDistance(name, a) < editDistance(name, b);
                           });
}

std::vector<std::string> describeUnknownParameters(const ros::NodeHandle& private_nh,
                                                   const std::vector<std::string>& known) {
  std::vector<std::string> messages;
  for (const std::string& name : namesBelow(private_nh)) {
    if (!holds(known, name) && !holds(kOfLibraries, name)) {
      messages.push_back(private_nh.resolveName(name) +
                         " is not a parameter of this node and is ignored. Did you mean " +
                         nearestName(name, known) + "?");
    }
  }
  return messages;
}

std::vector<std::string> describeUnknownArguments(const std::string& arguments,
                                                  const std::vector<std::string>& parameters) {
  const std::size_t colon = std::min(arguments.find(':'), arguments.size());
  const auto known = words(arguments.substr(std::min(colon + 1, arguments.size())));
  std::vector<std::string> all = known;
  all.insert(all.end(), parameters.begin(), parameters.end());
  std::vector<std::string> messages;
  for (const std::string& name : words(arguments.substr(0, colon))) {
    if (name.rfind("__", 0) == 0) {
      continue;  // reserved by roslaunch, for example __ns
    }
    const std::string nearest = nearestName(name, all);
    messages.push_back(
        name + " is not an argument of the launch file and is ignored. " +
        (holds(known, nearest) ? "Did you mean " + nearest + "?" : parameterAdvice(name, nearest)));
  }
  return messages;
}

}  // namespace cbmv
