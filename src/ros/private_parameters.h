#pragma once

#include <string>
#include <variant>
#include <vector>

#include <ros/node_handle.h>

namespace cbmv {

using PrivateValue = std::variant<bool, int, double, std::string>;

/// A private parameter that is read once, at the start of a nodelet.
struct PrivateParameter {
  std::string name;
  PrivateValue default_value;
  double lowest = 0;   ///< numbers only, inclusive
  double highest = 0;  ///< numbers only, inclusive
  std::string unit;
  std::string description;
};

/// Private parameters of the nodelet cbmv_stereo/stereo, in the order of docs/ros.md.
std::vector<PrivateParameter> stereoPrivateParameters();

/// Private parameters of the nodelet cbmv_stereo/point_cloud2.
std::vector<PrivateParameter> pointCloudPrivateParameters();

std::vector<std::string> namesOf(const std::vector<PrivateParameter>& table);

/// "1000000", not "1e+06".
std::string numberText(double value);

/// "0 to 1000000".
std::string rangeText(double lowest, double highest);

/// The values of a parameter table on the parameter server.
class PrivateParameters {
 public:
  PrivateParameters(const ros::NodeHandle& private_nh, std::vector<PrivateParameter> table);

  /// Returns the value if it is set, else the default. Value is the type of the default. Throws
  /// Error if the value has the wrong type or is out of range, and std::logic_error for a name or
  /// type that is not in the table.
  template <typename Value>
  Value get(const std::string& name) const;

  const ros::NodeHandle& nodeHandle() const { return private_nh_; }

 private:
  const PrivateParameter& find(const std::string& name) const;

  ros::NodeHandle private_nh_;
  std::vector<PrivateParameter> table_;
};

}  // namespace cbmv
