# Programs that read and write bags. They need no ROS master.
file(GLOB offline_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/offline/*.cpp)
if(CBMV_BUILD_FUZZERS)  # reads bags
  list(FILTER offline_sources INCLUDE REGEX "/(bag_reader|bag_set|frame_loader|frame_plan|pairing|stereo_topics)\\.cpp$")
endif()
add_library(cbmv_offline STATIC ${offline_sources})
target_include_directories(cbmv_offline SYSTEM PUBLIC ${rosbag_INCLUDE_DIRS} ${image_geometry_INCLUDE_DIRS})
target_compile_definitions(cbmv_offline PRIVATE CBMV_VERSION="${PROJECT_VERSION}")
target_link_libraries(cbmv_offline
  PUBLIC cbmv_ros ${rosbag_LIBRARIES} ${image_geometry_LIBRARIES}
  PRIVATE nlohmann_json::nlohmann_json)

cbmv_add_tool(cbmv_bag ros/cbmv_bag.cpp cbmv_offline)
cbmv_add_tool(cbmv_demo ros/cbmv_demo.cpp cbmv_ros cbmv_evaluation ${rosbag_LIBRARIES}
              ${camera_calibration_parsers_LIBRARIES})
target_sources(cbmv_demo PRIVATE ${PROJECT_SOURCE_DIR}/src/tools/ros/raw_demo.cpp)
target_include_directories(cbmv_demo SYSTEM PRIVATE ${rosbag_INCLUDE_DIRS} ${camera_calibration_parsers_INCLUDE_DIRS})
