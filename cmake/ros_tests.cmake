# Tests of the ROS targets. test/ros/NAME_test.cpp need no ROS master and become plain programs.
# test/ros/NAME.test.in are rostest launch files, which run test/ros/NAME_rostest.cpp.
find_package(rostest REQUIRED)
find_package(stereo_image_proc QUIET)  # the node is compared with it
find_package(image_proc QUIET)
find_package(depth_image_proc QUIET)  # subscribes to depth

function(cbmv_link_ros_test target)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/test)
  target_link_libraries(${target} PRIVATE cbmv_ros cbmv_evaluation ${image_geometry_LIBRARIES} cbmv_gtest)
  add_dependencies(tests ${target})
endfunction()

file(GLOB ros_test_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/ros/*_test.cpp)
foreach(test_source ${ros_test_sources})
  get_filename_component(test_name ${test_source} NAME_WE)
  add_executable(${test_name} EXCLUDE_FROM_ALL ${test_source})
  cbmv_link_ros_test(${test_name})
  target_link_libraries(${test_name} PRIVATE cbmv_gtest_main)
  target_compile_definitions(${test_name} PRIVATE CBMV_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
    CBMV_STOCK_LAUNCH_FILE="${stereo_image_proc_PREFIX}/share/stereo_image_proc/launch/stereo_image_proc.launch")
  set_target_properties(${test_name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  add_test(NAME ${test_name} COMMAND ${test_name})
endforeach()

# Bag processing: the library and the program.
file(GLOB offline_test_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/offline/*_test.cpp)
foreach(test_source ${offline_test_sources})
  get_filename_component(test_name ${test_source} NAME_WE)
  add_executable(${test_name} EXCLUDE_FROM_ALL ${test_source})
  cbmv_link_ros_test(${test_name})
  target_link_libraries(${test_name} PRIVATE cbmv_offline cbmv_gtest_main)
  target_compile_definitions(${test_name} PRIVATE CBMV_TOOLS_DIR="$<TARGET_FILE_DIR:cbmv_bag>"
                             CBMV_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_dependencies(${test_name} cbmv_bag)
  set_target_properties(${test_name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  add_test(NAME ${test_name} COMMAND ${test_name})
endforeach()

# Forest of the node under test. The tests do not depend on a trained forest.
set(CBMV_TEST_FOREST ${PROJECT_BINARY_DIR}/test/fixture.forest)
add_executable(write_forest_fixture EXCLUDE_FROM_ALL
               ${PROJECT_SOURCE_DIR}/test/ros/write_forest_fixture.cpp)
target_include_directories(write_forest_fixture PRIVATE ${PROJECT_SOURCE_DIR}/test)
target_link_libraries(write_forest_fixture PRIVATE cbmv_core)
set_target_properties(write_forest_fixture PROPERTIES
                      RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
add_custom_command(OUTPUT ${CBMV_TEST_FOREST}
                   COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/test
                   COMMAND write_forest_fixture ${CBMV_TEST_FOREST}
                   VERBATIM)
add_custom_target(forest_fixture DEPENDS ${CBMV_TEST_FOREST})

# Programs that rostest runs. It searches them in catkin's program folder.
set(CBMV_ROSTESTS stereo configuration uncertainty launch_names point_cloud worker_threads faults faults_time
    faults_parameters faults_lifecycle faults_sim_time)
set(launch_files stereo_node stereo_nodelet configuration launch_names worker_threads faults faults_lifecycle
    faults_sim_time)
if(stereo_image_proc_FOUND AND image_proc_FOUND)
  list(APPEND CBMV_ROSTESTS parity replacement frame_path)
  list(APPEND launch_files parity replacement frame_path)
else()
  message(STATUS "stereo_image_proc or image_proc is missing: nothing is compared with them")
endif()
if(stereo_image_proc_FOUND AND depth_image_proc_FOUND)
  list(APPEND CBMV_ROSTESTS consumers)
  list(APPEND launch_files consumers)
endif()
foreach(test_name ${CBMV_ROSTESTS})
  set(program ${test_name}_rostest)
  add_executable(${program} EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/test/ros/${program}.cpp)
  cbmv_link_ros_test(${program})
  target_compile_definitions(${program} PRIVATE CBMV_TEST_FOREST="${CBMV_TEST_FOREST}"
                             CBMV_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             CBMV_STEREO_NODE="$<TARGET_FILE:cbmv_stereo_node>"
                             CBMV_TOOLS_DIR="$<TARGET_FILE_DIR:cbmv_match>"
                             CBMV_NODELET_PROGRAM="${nodelet_PREFIX}/lib/nodelet/nodelet")
  target_link_libraries(${program} PRIVATE ${catkin_LIBRARIES} ${rosbag_LIBRARIES})
endforeach()
list(TRANSFORM CBMV_ROSTESTS APPEND _rostest)
add_custom_target(rostests DEPENDS ${CBMV_ROSTESTS} forest_fixture cbmv_stereo_node cbmv_stereo_nodelets cbmv_bag cbmv_match)
add_dependencies(tests rostests)
foreach(name ${launch_files})
  set(launch_file ${PROJECT_BINARY_DIR}/test/${name}.test)
  configure_file(${PROJECT_SOURCE_DIR}/test/ros/${name}.test.in ${launch_file} @ONLY)
  add_rostest(${launch_file} DEPENDENCIES rostests)
endforeach()

# Processes shards on a cluster; skipped unless CBMV_TEST_CLUSTER=1.
add_test(NAME cluster_test COMMAND ${PROJECT_SOURCE_DIR}/test/scripts/cluster_test.py
                                   $<TARGET_FILE:cbmv_bag> ${CBMV_TEST_FOREST})
set_tests_properties(cluster_test PROPERTIES SKIP_RETURN_CODE 77)

# Runs the node under load for a minute. scripts/soak starts the node and soak_driver, which publishes the
# input and measures the node. The processing time per frame is long, so that short interruptions by other
# processes do not matter.
add_executable(soak_driver EXCLUDE_FROM_ALL ${PROJECT_SOURCE_DIR}/test/ros/soak_driver.cpp)
cbmv_link_ros_test(soak_driver)
target_link_libraries(soak_driver PRIVATE ${catkin_LIBRARIES} CLI11::CLI11 nlohmann_json::nlohmann_json)
add_test(NAME soak_test
         COMMAND ${PROJECT_SOURCE_DIR}/scripts/soak --build ${PROJECT_BINARY_DIR} --seconds 60
                 --size 320x240 --disparities 64 --preset quality --json ${PROJECT_BINARY_DIR}/test/soak.json)
set_tests_properties(soak_test PROPERTIES RUN_SERIAL TRUE TIMEOUT 300)
