# Command-line programs: src/tools/NAME.cpp becomes NAME, linked with the other files of this folder.
file(GLOB tool_support_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/tools/*.cpp)
list(FILTER tool_support_sources EXCLUDE REGEX "/cbmv_[^/]*$")
add_library(cbmv_tool_support STATIC ${tool_support_sources})
target_compile_definitions(cbmv_tool_support PUBLIC CBMV_VERSION="${PROJECT_VERSION}"
                           PRIVATE CBMV_SOURCE_TREE="${PROJECT_SOURCE_DIR}")
target_link_libraries(cbmv_tool_support PUBLIC cbmv_core CLI11::CLI11)

set(CBMV_TOOLS)
function(cbmv_add_tool tool source)
  add_executable(${tool} ${PROJECT_SOURCE_DIR}/src/tools/${source})
  target_link_libraries(${tool} PRIVATE cbmv_tool_support ${ARGN})
  set(CBMV_TOOLS ${CBMV_TOOLS} ${tool} PARENT_SCOPE)
endfunction()

cbmv_add_tool(cbmv_match cbmv_match.cpp)
if(CBMV_WITH_TRAINING)
  foreach(tool cbmv_eval cbmv_train cbmv_tune)
    cbmv_add_tool(${tool} ${tool}.cpp cbmv_training)
  endforeach()
  # cbmv_eval searches the program that creates its page in its own folder.
  add_custom_command(TARGET cbmv_eval POST_BUILD
                     COMMAND ${CMAKE_COMMAND} -E create_symlink
                             ${PROJECT_SOURCE_DIR}/scripts/evaluation_report
                             $<TARGET_FILE_DIR:cbmv_eval>/cbmv_evaluation_report
                     VERBATIM)
endif()
if(CBMV_BUILD_ROS)
  include(cmake/ros_tools.cmake)
endif()
