# Downloads libraries that the system does not provide (see dependencies.cmake). Without network access, set
# FETCHCONTENT_SOURCE_DIR_HIGHWAY and FETCHCONTENT_SOURCE_DIR_CLI11 to the folders of their unpacked
# releases. Each is downloaded at most once, into the build folder, and never installed.
include(FetchContent)

# Highway: SIMD that selects the best instruction set at run time.
function(cbmv_fetch_highway)
  foreach(part CONTRIB EXAMPLES INSTALL TESTS)
    set(HWY_ENABLE_${part} OFF CACHE BOOL "Part of Highway" FORCE)
  endforeach()
  set(HWY_FORCE_STATIC_LIBS ON CACHE BOOL "Highway is linked into the library cbmv" FORCE)
  FetchContent_Declare(highway
    URL https://github.com/google/highway/archive/refs/tags/1.0.3.tar.gz
    URL_HASH SHA256=566fc77315878473d9a6bd815f7de78c73734acdcb745c3dde8579560ac5440e)
  cbmv_add_fetched(highway hwy)
  add_library(hwy::hwy ALIAS hwy)
endfunction()

# CLI11: command line parser, headers only.
function(cbmv_fetch_cli11)
  FetchContent_Declare(cli11
    URL https://github.com/CLIUtils/CLI11/archive/refs/tags/v2.1.2.tar.gz
    URL_HASH SHA256=26291377e892ba0e5b4972cdfd4a2ab3bf53af8dac1f4ea8fe0d1376b625c8cb)
  cbmv_add_fetched(cli11 CLI11)
endfunction()

# Adds a project without its other targets. Its headers are treated as system headers, without warnings.
function(cbmv_add_fetched name target)
  FetchContent_GetProperties(${name})
  if(NOT ${name}_POPULATED)
    message(STATUS "${name} is not installed, or too old: its release is fetched")
    if(POLICY CMP0169)  # FetchContent_MakeAvailable has no EXCLUDE_FROM_ALL before CMake 3.28
      cmake_policy(SET CMP0169 OLD)
    endif()
    FetchContent_Populate(${name})
    set(CMAKE_POLICY_VERSION_MINIMUM 3.5)  # required by CMake 4
    add_subdirectory(${${name}_SOURCE_DIR} ${${name}_BINARY_DIR} EXCLUDE_FROM_ALL)
  endif()
  get_target_property(include_directories ${target} INTERFACE_INCLUDE_DIRECTORIES)
  set_target_properties(${target} PROPERTIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${include_directories}")
endfunction()
