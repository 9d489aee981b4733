# test/STAGE/NAME_test.cpp becomes the program NAME_test and one entry of ctest (an entry a case
# would load OpenCV a thousand times).
find_package(GTest REQUIRED)
enable_testing()

if(NOT TARGET tests)
  add_custom_target(tests)
endif()
file(GLOB test_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/test/*/*_test.cpp)
list(FILTER test_sources EXCLUDE REGEX "/test/ros/")
foreach(test_source ${test_sources})
  get_filename_component(test_name ${test_source} NAME_WE)
  add_executable(${test_name} EXCLUDE_FROM_ALL ${test_source})
  target_include_directories(${test_name} PRIVATE ${PROJECT_SOURCE_DIR}/test)
  target_compile_definitions(${test_name} PRIVATE CBMV_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             ${CBMV_HIGHWAY_OPTIONS})
  target_link_libraries(${test_name} PRIVATE cbmv hwy::hwy TBB::tbb GTest::gtest GTest::gtest_main gmock)
  if(test_source MATCHES "/test/(training|tuning)/|/folds_test")
    target_link_libraries(${test_name} PRIVATE cbmv_training xgboost_c_api)
  endif()
  add_dependencies(tests ${test_name})
  set_target_properties(${test_name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  add_test(NAME ${test_name} COMMAND ${test_name})
endforeach()
# The tests of the command-line programs run them.
foreach(tool ${CBMV_TOOLS})
  add_dependencies(tools_test ${tool})
endforeach()
target_compile_definitions(tools_test PRIVATE CBMV_TOOLS_DIR="$<TARGET_FILE_DIR:cbmv_match>")

if(CBMV_BUILD_ROS AND CATKIN_ENABLE_TESTING)
  include(cmake/ros_tests.cmake)
endif()
