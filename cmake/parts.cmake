# Selects the parts to build. Core and node are always built. AUTO: a part is built if its dependencies are
# found. At the end of the configuration, cbmv_list_parts lists skipped parts and their missing packages.
option(CBMV_BUILD_ROS "Build messages, nodelets and node (needs catkin)" ON)
option(CBMV_MESSAGES_ONLY "Build the message definitions and nothing else" OFF)
option(CBMV_DEVELOPER "Build the benchmarks, too" OFF)
option(CBMV_BUILD_FUZZERS "Build the fuzzers (target `fuzzers`, needs clang) instead of the tests" OFF)
set(CBMV_BUILD_TOOLS AUTO CACHE STRING
    "Command-line programs: AUTO (where CLI11 is found), ON (CLI11 is fetched where it is missing) or OFF")
set(CBMV_BUILD_TRAINING AUTO CACHE STRING
    "cbmv_eval, cbmv_train and cbmv_tune: AUTO (where XGBoost and NLopt are found), ON or OFF")
foreach(choice CBMV_BUILD_TOOLS CBMV_BUILD_TRAINING)
  set_property(CACHE ${choice} PROPERTY STRINGS AUTO ON OFF)
  if(NOT ${choice} MATCHES "^(AUTO|ON|OFF|TRUE|FALSE|YES|NO|[01])$")
    message(FATAL_ERROR "${choice} is '${${choice}}', expected AUTO, ON or OFF.")
  endif()
endforeach()
if(CBMV_MESSAGES_ONLY AND NOT CBMV_BUILD_ROS)
  message(FATAL_ERROR "CBMV_MESSAGES_ONLY is ON and CBMV_BUILD_ROS is OFF, so nothing would be built, expected "
                      "CBMV_BUILD_ROS=ON. For the library without ROS, give -DCBMV_MESSAGES_ONLY=OFF.")
endif()

set(CBMV_LEFT_OUT)

# Sets `result` to whether a part is built. `choice` is the name of its option. The remaining arguments are
# pairs: a variable that tells whether a dependency was found, and its Debian package.
function(cbmv_decide result choice description)
  set(missing)
  set(needs ${ARGN})
  while(needs)
    list(GET needs 0 found)
    list(GET needs 1 package)
    list(REMOVE_AT needs 0 1)
    if(NOT ${found})
      list(APPEND missing ${package})
    endif()
  endwhile()
  string(REPLACE ";" ", " missing "${missing}")
  set(built ON)
  if("${${choice}}" STREQUAL "AUTO" AND missing)
    set(built OFF)
    list(APPEND CBMV_LEFT_OUT "${description}. Needs ${missing}")
  elseif(NOT "${${choice}}" STREQUAL "AUTO" AND NOT ${choice})
    set(built OFF)
    list(APPEND CBMV_LEFT_OUT "${description}. Needs -D${choice}=ON")
  elseif(missing)
    message(FATAL_ERROR "${choice} is ${${choice}}, but its dependencies are missing. "
                        "Provide ${missing}, or give -D${choice}=OFF.")
  endif()
  set(${result} ${built} PARENT_SCOPE)
  set(CBMV_LEFT_OUT ${CBMV_LEFT_OUT} PARENT_SCOPE)
endfunction()

function(cbmv_list_parts)
  foreach(part ${CBMV_LEFT_OUT})
    message(STATUS "Not built: ${part}")
  endforeach()
endfunction()
