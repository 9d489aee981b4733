#pragma once

#include <cstddef>

#include <nodelet/NodeletList.h>
#include <ros/ros.h>

#include "ros/wait_for.h"

namespace cbmv {

/// Waits until /manager has loaded `count` nodelets. Until a nodelet is loaded, nodelet 1.10.0
/// (Debian 11) discards its callbacks: calls of its services never return, and subscribers that
/// connect are not noticed. The nodelets of this package accept them (acceptCallbacks), others do
/// not.
inline bool waitForNodelets(std::size_t count) {
  const auto all_are_loaded = [count] {
    nodelet::NodeletList list;
    return ros::service::call("/manager/list", list) && list.response.nodelets.size() == count;
  };
  return ros::service::waitForService("/manager/list", 20000) && waitFor(all_are_loaded);
}

}  // namespace cbmv
