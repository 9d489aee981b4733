# Command-line programs: src/tools/NAME.cpp becomes NAME, linked with the core only.
find_package(CLI11 REQUIRED)

set(CBMV_TOOLS)
file(GLOB tool_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/tools/cbmv_*.cpp)
foreach(tool_source ${tool_sources})
  get_filename_component(tool ${tool_source} NAME_WE)
  add_executable(${tool} ${tool_source})
  target_link_libraries(${tool} PRIVATE cbmv CLI11::CLI11)
  list(APPEND CBMV_TOOLS ${tool})
endforeach()

# cbmv_eval looks for the program that makes its page beside itself.
add_custom_command(TARGET cbmv_eval POST_BUILD
                   COMMAND ${CMAKE_COMMAND} -E create_symlink
                           ${PROJECT_SOURCE_DIR}/scripts/evaluation_report
                           $<TARGET_FILE_DIR:cbmv_eval>/cbmv_evaluation_report)
