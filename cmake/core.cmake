# The core without ROS: one folder per stage, in the order of their dependencies.
#   cbmv       shared, for applications; exports only the API in include/cbmv_stereo
#   cbmv_core  static, for the targets of this package; all headers are accessible
set(CBMV_STAGES base input io rectification matching confidence forest volume optimization search refinement
    selection output pipeline)
set(core_sources)
foreach(stage ${CBMV_STAGES})
  file(GLOB stage_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/${stage}/*.cpp)
  list(APPEND core_sources ${stage_sources})
endforeach()

add_library(cbmv_objects OBJECT ${core_sources})
# The vector code includes itself once per instruction set, with its path relative to src.
target_include_directories(cbmv_objects PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
target_include_directories(cbmv_objects SYSTEM PRIVATE ${OpenCV_INCLUDE_DIRS})
target_compile_definitions(cbmv_objects PRIVATE ${CBMV_HIGHWAY_OPTIONS})
set_target_properties(cbmv_objects PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # gcc's own AVX-512 header uses variables that are uninitialized on purpose (gcc bug 105593).
  target_compile_options(cbmv_objects PRIVATE -Wno-maybe-uninitialized)
endif()
set(core_dependencies Eigen3::Eigen hwy::hwy nlohmann_json::nlohmann_json yaml-cpp ZLIB::ZLIB TBB::tbb
    Threads::Threads)
target_link_libraries(cbmv_objects PRIVATE ${OpenCV_LIBS} ${core_dependencies})

add_library(cbmv SHARED $<TARGET_OBJECTS:cbmv_objects>)
add_library(cbmv::cbmv ALIAS cbmv)
target_compile_features(cbmv PUBLIC cxx_std_17)
target_include_directories(cbmv PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(cbmv PUBLIC opencv_core PRIVATE ${OpenCV_LIBS} ${core_dependencies})
# Compiler flags cannot hide templates of the standard library, so the linker does.
set(version_script ${PROJECT_SOURCE_DIR}/cmake/cbmv.map)
target_link_options(cbmv PRIVATE LINKER:--version-script=${version_script})
set_target_properties(cbmv PROPERTIES LINK_DEPENDS ${version_script}
                      VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})

add_library(cbmv_core STATIC $<TARGET_OBJECTS:cbmv_objects>)
target_include_directories(cbmv_core PUBLIC ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
target_include_directories(cbmv_core SYSTEM PUBLIC ${OpenCV_INCLUDE_DIRS})
target_link_libraries(cbmv_core PUBLIC ${OpenCV_LIBS} TBB::tbb PRIVATE ${core_dependencies})
