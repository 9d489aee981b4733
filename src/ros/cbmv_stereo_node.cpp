// Runs the nodelet cbmv_stereo/stereo as a standalone node.

#include <iostream>
#include <string>

#include <nodelet/loader.h>
#include <ros/ros.h>

int main(int argc, char** argv) {
  if (argc == 2 && std::string(argv[1]) == "--version") {
    std::cout << "cbmv_stereo_node " CBMV_VERSION "\n";
    return 0;
  }
  ros::init(argc, argv, "cbmv_stereo");
  nodelet::Loader loader(false);
  if (!loader.load(ros::this_node::getName(), "cbmv_stereo/stereo", ros::names::getRemappings(),
                   {argv + 1, argv + argc})) {
    std::cerr
        << "cbmv_stereo_node: the nodelet cbmv_stereo/stereo did not start. See the error above\n";
    return 1;
  }
  ros::spin();
  return 0;
}
