# The ROS-free library `cbmv`: every folder of src but training, tuning, ros and tools.
find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs features2d calib3d)
find_package(Eigen3 REQUIRED)
cbmv_find_highway()
find_package(nlohmann_json REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Threads REQUIRED)
# AVX-512 with byte permutations has to be asked for. Highway avoids its emulated vectors, for machines
# without any of its instruction sets, with gcc before 12.3, which gets the upper half of 16-bit
# products wrong (gcc bug 106322); nothing here computes one, and the tests run on these vectors too.
set(CBMV_HIGHWAY_OPTIONS HWY_WANT_AVX3_DL HWY_BROKEN_EMU128=0)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 11)
  list(APPEND CBMV_HIGHWAY_OPTIONS HWY_DISABLED_TARGETS=HWY_AVX3_DL)  # it asks for avxvnni, too
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

set(CBMV_STAGES input rectification matching confidence forest volume search optimization refinement selection pipeline
    output io evaluation)
set(CBMV_SOURCES)
foreach(stage ${CBMV_STAGES})
  file(GLOB stage_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${stage}/*.cpp)
  list(APPEND CBMV_SOURCES ${stage_sources})
endforeach()

add_library(cbmv SHARED ${CBMV_SOURCES})
target_include_directories(cbmv PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
target_include_directories(cbmv SYSTEM PUBLIC ${OpenCV_INCLUDE_DIRS})
# The vector code includes itself once per instruction set, by its path below src.
target_include_directories(cbmv PRIVATE ${PROJECT_SOURCE_DIR}/src)
target_compile_definitions(cbmv PRIVATE ${CBMV_HIGHWAY_OPTIONS})
target_link_libraries(cbmv
  PUBLIC ${OpenCV_LIBS}
  PRIVATE Eigen3::Eigen hwy::hwy nlohmann_json::nlohmann_json yaml-cpp ZLIB::ZLIB TBB::tbb Threads::Threads)

# Training and tuning, for the command-line programs alone: no node has to load XGBoost and NLopt.
# Debian's CMake files for XGBoost want its program too, which is of no use here.
find_path(XGBOOST_INCLUDE_DIR xgboost/c_api.h)
find_library(XGBOOST_LIBRARY xgboost)
if(NOT XGBOOST_INCLUDE_DIR OR NOT XGBOOST_LIBRARY)
  message(FATAL_ERROR "XGBoost's library is missing: install libxgboost-dev")
endif()
add_library(xgboost_c_api UNKNOWN IMPORTED)
set_target_properties(xgboost_c_api PROPERTIES IMPORTED_LOCATION ${XGBOOST_LIBRARY}
                      INTERFACE_INCLUDE_DIRECTORIES ${XGBOOST_INCLUDE_DIR})
find_package(NLopt REQUIRED)
file(GLOB training_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/training/*.cpp
     ${PROJECT_SOURCE_DIR}/src/tuning/*.cpp)
add_library(cbmv_training STATIC ${training_sources})
target_compile_definitions(cbmv_training PRIVATE CBMV_VERSION="${PROJECT_VERSION}")
target_link_libraries(cbmv_training PUBLIC cbmv
  PRIVATE xgboost_c_api NLopt::nlopt nlohmann_json::nlohmann_json TBB::tbb)
