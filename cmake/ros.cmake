# ROS targets: the static library `cbmv_ros` (conversions and nodelets, for use in this package), the nodelet
# plugin `cbmv_stereo_nodelets`, and the program `cbmv_stereo_node`.
file(GLOB ros_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/ros/*.cpp)
list(FILTER ros_sources EXCLUDE REGEX "_node\\.cpp$")
if(CBMV_BUILD_FUZZERS)  # reads messages
  list(FILTER ros_sources INCLUDE REGEX "/(camera_info|color_buffer|conversions|image_conversion|point_cloud)\\.cpp$")
endif()
add_library(cbmv_ros_objects OBJECT ${ros_sources})
add_dependencies(cbmv_ros_objects ${${PROJECT_NAME}_EXPORTED_TARGETS} ${catkin_EXPORTED_TARGETS})
target_include_directories(cbmv_ros_objects SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(cbmv_ros_objects PRIVATE cbmv_core)

add_library(cbmv_ros STATIC $<TARGET_OBJECTS:cbmv_ros_objects>)
target_include_directories(cbmv_ros SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(cbmv_ros PUBLIC cbmv_core ${catkin_LIBRARIES})
add_dependencies(cbmv_ros ${${PROJECT_NAME}_EXPORTED_TARGETS})

add_library(cbmv_stereo_nodelets SHARED $<TARGET_OBJECTS:cbmv_ros_objects>)
target_link_libraries(cbmv_stereo_nodelets PRIVATE cbmv_core ${catkin_LIBRARIES})
target_link_options(cbmv_stereo_nodelets PRIVATE LINKER:--exclude-libs,ALL)

add_executable(cbmv_stereo_node ${PROJECT_SOURCE_DIR}/src/ros/cbmv_stereo_node.cpp)
target_include_directories(cbmv_stereo_node SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(cbmv_stereo_node PRIVATE ${catkin_LIBRARIES})
target_compile_definitions(cbmv_stereo_node PRIVATE CBMV_VERSION="${PROJECT_VERSION}")
