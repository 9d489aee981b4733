# What catkin needs to know before any target: packages, messages, parameters, exports.
set(CBMV_CATKIN_DEPENDS cv_bridge diagnostic_updater dynamic_reconfigure image_transport message_filters nodelet
    pluginlib roscpp roslib sensor_msgs std_msgs stereo_msgs)
find_package(catkin REQUIRED COMPONENTS ${CBMV_CATKIN_DEPENDS} message_generation)

add_message_files(FILES Rectification.msg Status.msg)
generate_messages(DEPENDENCIES std_msgs)
generate_dynamic_reconfigure_options(cfg/Stereo.cfg)

catkin_package(
  INCLUDE_DIRS include
  LIBRARIES cbmv cbmv_stereo_nodelets
  CATKIN_DEPENDS ${CBMV_CATKIN_DEPENDS} message_runtime)
