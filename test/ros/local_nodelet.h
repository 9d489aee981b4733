#pragma once

#include <string>

#include <nodelet/loader.h>
#include <ros/ros.h>

namespace cbmv {

/// A nodelet in this process, with its own namespace for topics and parameters.
class LocalNodelet {
 public:
  explicit LocalNodelet(const std::string& name_space, const std::string& type)
      : name_("/" + name_space + "/nodelet"), type_(type), parameters_(name_), loader_(false) {}
  ~LocalNodelet() { parameters_.deleteParam(name_); }

  ros::NodeHandle& parameters() { return parameters_; }
  bool load(const ros::M_string& remappings = {}) {
    return loader_.load(name_, type_, remappings, {});
  }
  bool unload() { return loader_.unload(name_); }

 private:
  std::string name_;
  std::string type_;
  ros::NodeHandle parameters_;
  nodelet::Loader loader_;
};

}  // namespace cbmv
