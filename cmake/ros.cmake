# The library `cbmv_stereo_nodelets` (conversions and nodelet) and the program `cbmv_stereo_node`.
file(GLOB ros_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/ros/*.cpp)
list(FILTER ros_sources EXCLUDE REGEX "_node\\.cpp$")
if(CBMV_BUILD_FUZZERS)  # what reads messages
  list(FILTER ros_sources INCLUDE REGEX "/(camera_info|color_buffer|conversions|image_conversion|point_cloud)\\.cpp$")
endif()

add_library(cbmv_stereo_nodelets SHARED ${ros_sources})
target_include_directories(cbmv_stereo_nodelets PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_include_directories(cbmv_stereo_nodelets SYSTEM PUBLIC ${catkin_INCLUDE_DIRS})
target_link_libraries(cbmv_stereo_nodelets PUBLIC cbmv ${catkin_LIBRARIES})
add_dependencies(cbmv_stereo_nodelets ${${PROJECT_NAME}_EXPORTED_TARGETS}
                 ${catkin_EXPORTED_TARGETS})

add_executable(cbmv_stereo_node ${PROJECT_SOURCE_DIR}/src/ros/cbmv_stereo_node.cpp)
target_include_directories(cbmv_stereo_node SYSTEM PRIVATE ${catkin_INCLUDE_DIRS})
target_link_libraries(cbmv_stereo_node PRIVATE ${catkin_LIBRARIES})
target_compile_definitions(cbmv_stereo_node PRIVATE CBMV_VERSION="${PROJECT_VERSION}")

# Recordings, without a master: the library `cbmv_offline` of the program cbmv_bag.
find_package(rosbag REQUIRED)
find_package(image_geometry REQUIRED)
file(GLOB offline_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/offline/*.cpp)
if(CBMV_BUILD_FUZZERS)  # what reads bags
  list(FILTER offline_sources INCLUDE REGEX "/(bag_reader|bag_set|frame_loader|frame_plan|pairing|stereo_topics)\\.cpp$")
endif()
add_library(cbmv_offline STATIC ${offline_sources})
target_include_directories(cbmv_offline PUBLIC ${PROJECT_SOURCE_DIR}/src)
target_include_directories(cbmv_offline SYSTEM PUBLIC ${rosbag_INCLUDE_DIRS}
                           ${image_geometry_INCLUDE_DIRS})
target_compile_definitions(cbmv_offline PRIVATE CBMV_VERSION="${PROJECT_VERSION}")
target_link_libraries(cbmv_offline
  PUBLIC cbmv_stereo_nodelets ${rosbag_LIBRARIES} ${image_geometry_LIBRARIES}
  PRIVATE nlohmann_json::nlohmann_json TBB::tbb)

# Command-line programs that read and write bags.
cbmv_find_cli11()
file(GLOB ros_tool_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/tools/ros/cbmv_*.cpp)
set(CBMV_ROS_TOOLS)
foreach(tool_source ${ros_tool_sources})
  get_filename_component(tool ${tool_source} NAME_WE)
  add_executable(${tool} ${tool_source})
  target_include_directories(${tool} PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_include_directories(${tool} SYSTEM PRIVATE ${rosbag_INCLUDE_DIRS})
  target_link_libraries(${tool} PRIVATE cbmv_stereo_nodelets ${rosbag_LIBRARIES} CLI11::CLI11)
  list(APPEND CBMV_ROS_TOOLS ${tool})
endforeach()
target_link_libraries(cbmv_bag PRIVATE cbmv_offline cbmv_tool_support)
find_package(camera_calibration_parsers REQUIRED)
target_sources(cbmv_demo PRIVATE ${PROJECT_SOURCE_DIR}/src/tools/ros/raw_demo.cpp)
target_include_directories(cbmv_demo SYSTEM PRIVATE ${camera_calibration_parsers_INCLUDE_DIRS})
target_link_libraries(cbmv_demo PRIVATE cbmv_tool_support ${camera_calibration_parsers_LIBRARIES})
