// The nodelet cbmv_stereo/stereo in a process of its own.

#include <iostream>

#include <nodelet/loader.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  ros::init(argc, argv, "cbmv_stereo");
  nodelet::Loader loader(false);
  if (!loader.load(ros::this_node::getName(), "cbmv_stereo/stereo", ros::names::getRemappings(),
                   {argv + 1, argv + argc})) {
    std::cerr << "cbmv_stereo_node: the nodelet cbmv_stereo/stereo did not come up, see above\n";
    return 1;
  }
  ros::spin();
  return 0;
}
