# The ROS-free library `cbmv`: every folder of src but ros and tools.
find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs features2d calib3d)
find_package(Eigen3 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(ZLIB REQUIRED)
find_package(Threads REQUIRED)
find_package(TBB QUIET)
if(NOT TARGET TBB::tbb)  # Ubuntu 20.04's libtbb-dev has no CMake files
  find_path(TBB_INCLUDE_DIR tbb/parallel_for.h REQUIRED)
  find_library(TBB_LIBRARY tbb REQUIRED)
  add_library(TBB::tbb UNKNOWN IMPORTED)
  set_target_properties(TBB::tbb PROPERTIES IMPORTED_LOCATION ${TBB_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${TBB_INCLUDE_DIR})
endif()

set(CBMV_STAGES rectification matching confidence forest volume optimization refinement pipeline
    io evaluation training)
set(CBMV_SOURCES)
foreach(stage ${CBMV_STAGES})
  file(GLOB stage_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${stage}/*.cpp)
  list(APPEND CBMV_SOURCES ${stage_sources})
endforeach()

add_library(cbmv SHARED ${CBMV_SOURCES})
target_include_directories(cbmv PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
target_include_directories(cbmv SYSTEM PUBLIC ${OpenCV_INCLUDE_DIRS})
target_compile_definitions(cbmv PRIVATE CBMV_VERSION="${PROJECT_VERSION}")
target_link_libraries(cbmv
  PUBLIC ${OpenCV_LIBS}
  PRIVATE Eigen3::Eigen nlohmann_json::nlohmann_json yaml-cpp ZLIB::ZLIB TBB::tbb Threads::Threads)
