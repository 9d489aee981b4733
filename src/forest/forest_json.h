#pragma once

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "forest/forest.h"
#include "io/ordered_json.h"

namespace cbmv {

using Json = OrderedJson;

/// A fault in the content of a file, thrown where the file name is not known.
struct Fault : std::runtime_error {
  using std::runtime_error::runtime_error;
};

inline std::int64_t integerIn(const Json& value, std::int64_t lowest, std::int64_t highest,
                              const std::string& what) {
  // Rejects numbers beyond 64 bits or with a fraction, whose conversion is undefined.
  const bool is_integer =
      value.is_number_integer() &&
      (!value.is_number_unsigned() ||
       value.get<std::uint64_t>() <= std::uint64_t{std::numeric_limits<std::int64_t>::max()});
  if (!is_integer) {
    throw Fault(what + " is no whole number, or too large");
  }
  const auto number = value.get<std::int64_t>();
  if (number < lowest || number > highest) {
    throw Fault(what + " is " + std::to_string(number) + ", outside of [" + std::to_string(lowest) +
                ", " + std::to_string(highest) + "]");
  }
  return number;
}

/// Does not validate: the indices of the children may be out of range.
inline DecisionTree::Node innerNode(const Json& feature, const Json& threshold, const Json& low,
                                    const Json& high) {
  const auto child = [](const Json& place) {
    return static_cast<std::uint32_t>(
        integerIn(place, 0, std::numeric_limits<std::uint32_t>::max(), "the place of a node"));
  };
  return {threshold.get<float>(),
          static_cast<std::uint8_t>(integerIn(feature, 0, kFeatureCount - 1, "a tree's feature")),
          {child(low), child(high)}};
}

inline DecisionTree::Node leafNode(const Json& value, std::size_t place) {
  const auto itself = static_cast<std::uint32_t>(place);
  return {value.get<float>(), 0, {itself, itself}};
}

/// Reads a model that XGBoost 1 or later saved as JSON (`save_model`), trained on the values of the
/// features: binary:logistic or reg:squarederror, trees only. Throws Fault or Json::exception.
Forest forestFromXgboost(const Json& json);

}  // namespace cbmv
