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
  cbmv_add_fetched(highway hwy https://github.com/google/highway/archive/refs/tags/1.0.3.tar.gz
                   566fc77315878473d9a6bd815f7de78c73734acdcb745c3dde8579560ac5440e)
  add_library(hwy::hwy ALIAS hwy)
endfunction()

# CLI11: command line parser, headers only.
function(cbmv_fetch_cli11)
  cbmv_add_fetched(cli11 CLI11 https://github.com/CLIUtils/CLI11/archive/refs/tags/v2.1.2.tar.gz
                   26291377e892ba0e5b4972cdfd4a2ab3bf53af8dac1f4ea8fe0d1376b625c8cb)
endfunction()

# Downloads url to archive, unless it is there. FetchContent would not say what to do without network.
function(cbmv_download name url sha256 archive)
  string(TOUPPER ${name} upper_name)
  if(EXISTS ${archive} OR FETCHCONTENT_SOURCE_DIR_${upper_name} OR FETCHCONTENT_FULLY_DISCONNECTED)
    return()
  endif()
  message(STATUS "${name} is not installed, or too old: downloading ${url}")
  file(DOWNLOAD ${url} ${archive}.part STATUS status INACTIVITY_TIMEOUT 30)
  list(GET status 1 reason)
  if(status MATCHES "^0;")
    file(SHA256 ${archive}.part found)
    set(reason "the file has the SHA256 ${found}")
  endif()
  if(NOT found STREQUAL sha256)
    message(FATAL_ERROR
      "The download of ${name} failed: ${reason}. Expected ${url} with SHA256 ${sha256}. Without network, "
      "unpack this archive yourself, and give its folder as -DFETCHCONTENT_SOURCE_DIR_${upper_name}=FOLDER.")
  endif()
  file(RENAME ${archive}.part ${archive})
endfunction()

# Adds a project without its other targets. Its headers are treated as system headers, without warnings.
function(cbmv_add_fetched name target url sha256)
  set(archive ${CMAKE_BINARY_DIR}/_deps/${name}-${sha256}.tar.gz)
  cbmv_download(${name} ${url} ${sha256} ${archive})
  if(POLICY CMP0135)  # times of extracted files; before CMake 3.24 there was no choice
    cmake_policy(SET CMP0135 NEW)
  endif()
  FetchContent_Declare(${name} URL ${archive} URL_HASH SHA256=${sha256})
  FetchContent_GetProperties(${name})
  if(NOT ${name}_POPULATED)
    if(POLICY CMP0169)  # FetchContent_MakeAvailable has no EXCLUDE_FROM_ALL before CMake 3.28
      cmake_policy(SET CMP0169 OLD)
    endif()
    FetchContent_Populate(${name})
    set(CMAKE_POLICY_VERSION_MINIMUM 3.5)  # required by CMake 4
    add_subdirectory(${${name}_SOURCE_DIR} ${${name}_BINARY_DIR} EXCLUDE_FROM_ALL)
  endif()
  if(NOT TARGET ${target})
    string(TOUPPER ${name} upper_name)
    message(FATAL_ERROR "The folder ${${name}_SOURCE_DIR} does not define the target ${target}, expected the "
                        "unpacked release of ${name}. Correct FETCHCONTENT_SOURCE_DIR_${upper_name}.")
  endif()
  get_target_property(include_directories ${target} INTERFACE_INCLUDE_DIRECTORIES)
  set_target_properties(${target} PROPERTIES INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${include_directories}")
endfunction()
