#pragma once

#include <string>
#include <variant>
#include <vector>

#include <ros/node_handle.h>

namespace cbmv {

using PrivateValue = std::variant<bool, int, double, std::string>;

/// A private parameter that is read once, when a nodelet comes up.
struct PrivateParameter {
  std::string name;
  PrivateValue default_value;
  double lowest = 0;   ///< of numbers, inclusive
  double highest = 0;  ///< of numbers, inclusive
  std::string unit;
  std::string description;
};

/// What the nodelet cbmv_stereo/stereo reads, in the order of docs/ros.md.
std::vector<PrivateParameter> stereoPrivateParameters();

/// What the nodelet cbmv_stereo/point_cloud2 reads.
std::vector<PrivateParameter> pointCloudPrivateParameters();

std::vector<std::string> namesOf(const std::vector<PrivateParameter>& table);

/// "0 to 1000000".
std::string rangeText(double lowest, double highest);

/// The values on the parameter server of a table of parameters.
class PrivateParameters {
 public:
  PrivateParameters(const ros::NodeHandle& private_nh, std::vector<PrivateParameter> table);

  /// The value that was set, else the default; Value is the type of the default. Throws Error if
  /// what was set has another type or is out of range, and std::logic_error for a name or type that
  /// the table does not have.
  template <typename Value>
  Value get(const std::string& name) const;

  const ros::NodeHandle& nodeHandle() const { return private_nh_; }

 private:
  const PrivateParameter& find(const std::string& name) const;

  ros::NodeHandle private_nh_;
  std::vector<PrivateParameter> table_;
};

}  // namespace cbmv
