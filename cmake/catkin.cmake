# Settings that catkin needs before any target: packages, messages, parameters, exports.
if(CBMV_MESSAGES_ONLY)
  find_package(catkin REQUIRED COMPONENTS message_generation std_msgs)
  add_message_files(FILES Rectification.msg Status.msg)
  generate_messages(DEPENDENCIES std_msgs)
  catkin_package(CATKIN_DEPENDS message_runtime std_msgs)
  return()
endif()

set(CBMV_CATKIN_DEPENDS cv_bridge diagnostic_updater dynamic_reconfigure image_transport message_filters nodelet
    pluginlib roscpp roslib sensor_msgs std_msgs stereo_msgs)
find_package(catkin REQUIRED COMPONENTS ${CBMV_CATKIN_DEPENDS} message_generation)

add_message_files(FILES Rectification.msg Status.msg)
generate_messages(DEPENDENCIES std_msgs)
generate_dynamic_reconfigure_options(cfg/Stereo.cfg)

# The extra file defines cbmv::cbmv.
catkin_package(
  INCLUDE_DIRS include
  LIBRARIES cbmv
  CATKIN_DEPENDS ${CBMV_CATKIN_DEPENDS} message_runtime
  CFG_EXTRAS cbmv_stereo-extras.cmake)
