# Build dependencies of each part. package.xml lists those of core and node for ROS users.
include(cmake/fetch.cmake)

find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs features2d calib3d)
find_package(Eigen3 REQUIRED)
find_package(hwy 1.0.3 QUIET)
if(NOT hwy_FOUND)
  cbmv_fetch_highway()
endif()
find_package(nlohmann_json REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Threads REQUIRED)
# HWY_WANT_AVX3_DL: AVX-512 with byte permutations is off by default.
# HWY_BROKEN_EMU128: Highway disables its emulated vectors, for machines without a supported instruction
# set, for gcc before 12.3, which computes the upper half of 16-bit products incorrectly (gcc bug 106322).
# This package does not use these products, and the tests also run on emulated vectors.
set(CBMV_HIGHWAY_OPTIONS HWY_WANT_AVX3_DL HWY_BROKEN_EMU128=0)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 11)
  list(APPEND CBMV_HIGHWAY_OPTIONS HWY_DISABLED_TARGETS=HWY_AVX3_DL)  # requires avxvnni
endif()
find_package(TBB QUIET)
if(NOT TARGET TBB::tbb)  # Ubuntu 20.04's libtbb-dev has no CMake files
  find_path(TBB_INCLUDE_DIR tbb/parallel_for.h)
  find_library(TBB_LIBRARY tbb)
  if(NOT TBB_INCLUDE_DIR OR NOT TBB_LIBRARY)
    message(FATAL_ERROR "TBB is missing: install libtbb-dev")
  endif()
  add_library(TBB::tbb UNKNOWN IMPORTED)
  set_target_properties(TBB::tbb PROPERTIES IMPORTED_LOCATION ${TBB_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${TBB_INCLUDE_DIR})
endif()

# Tools
find_package(CLI11 2.1 QUIET)
if(NOT CLI11_FOUND AND NOT CBMV_BUILD_TOOLS STREQUAL "AUTO" AND CBMV_BUILD_TOOLS)
  cbmv_fetch_cli11()
  set(CLI11_FOUND ON)
endif()
set(tools_need CLI11_FOUND libcli11-dev)
if(CBMV_BUILD_ROS)
  find_package(rosbag QUIET)
  find_package(image_geometry QUIET)
  find_package(camera_calibration_parsers QUIET)
  list(APPEND tools_need rosbag_FOUND librosbag-dev image_geometry_FOUND libimage-geometry-dev
       camera_calibration_parsers_FOUND libcamera-calibration-parsers-dev)
endif()
cbmv_decide(CBMV_WITH_TOOLS CBMV_BUILD_TOOLS "command-line programs" ${tools_need})

# Training. Does not use Debian's CMake files for XGBoost, because they also require the XGBoost program.
find_path(XGBOOST_INCLUDE_DIR xgboost/c_api.h)
find_library(XGBOOST_LIBRARY xgboost)
find_package(NLopt QUIET)
cbmv_decide(CBMV_WITH_TRAINING CBMV_BUILD_TRAINING "cbmv_eval, cbmv_train and cbmv_tune"
            CBMV_WITH_TOOLS -DCBMV_BUILD_TOOLS=ON XGBOOST_LIBRARY libxgboost-dev NLopt_FOUND libnlopt-cxx-dev)
if(CBMV_WITH_TRAINING)
  add_library(xgboost_c_api UNKNOWN IMPORTED)
  set_target_properties(xgboost_c_api PROPERTIES IMPORTED_LOCATION ${XGBOOST_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${XGBOOST_INCLUDE_DIR})
endif()

# Tests, if enabled in catkin and CTest. They run the tools and the training. GoogleTest is found by its
# files, because the target names of CMake differ between versions, and catkin defines targets with the
# same names. As a part of another project, the package has no tests.
find_path(CBMV_GMOCK_INCLUDE_DIR gmock/gmock.h)
foreach(library gtest gmock gtest_main)
  find_library(CBMV_${library}_LIBRARY ${library})
endforeach()
set(tests_wanted OFF)
if((CATKIN_ENABLE_TESTING OR BUILD_TESTING) AND NOT CBMV_BUILD_FUZZERS
   AND (CBMV_BUILD_ROS OR CMAKE_SOURCE_DIR STREQUAL PROJECT_SOURCE_DIR))
  set(tests_wanted AUTO)
endif()
if(tests_wanted)
  cbmv_decide(CBMV_WITH_TESTS tests_wanted "tests" CBMV_WITH_TRAINING -DCBMV_BUILD_TRAINING=ON CBMV_gtest_main_LIBRARY
              libgtest-dev CBMV_gmock_LIBRARY libgmock-dev)
endif()

find_package(benchmark QUIET)
cbmv_decide(CBMV_WITH_BENCHMARKS CBMV_DEVELOPER "benchmarks" CBMV_WITH_TOOLS -DCBMV_BUILD_TOOLS=ON benchmark_FOUND
            libbenchmark-dev)
