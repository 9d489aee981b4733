# Command-line programs: src/tools/NAME.cpp becomes NAME, linked with the core, with what the programs
# share (the other files there), and with the training where it trains.
cbmv_find_cli11()

file(GLOB tool_support_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/tools/*.cpp)
list(FILTER tool_support_sources EXCLUDE REGEX "/cbmv_[^/]*$")
add_library(cbmv_tool_support STATIC ${tool_support_sources})
target_include_directories(cbmv_tool_support PUBLIC ${PROJECT_SOURCE_DIR}/src)
target_compile_definitions(cbmv_tool_support PUBLIC CBMV_VERSION="${PROJECT_VERSION}"
                           PRIVATE CBMV_SOURCE_TREE="${PROJECT_SOURCE_DIR}")
target_link_libraries(cbmv_tool_support PUBLIC cbmv)

set(CBMV_TOOLS)
file(GLOB tool_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/tools/cbmv_*.cpp)
foreach(tool_source ${tool_sources})
  get_filename_component(tool ${tool_source} NAME_WE)
  add_executable(${tool} ${tool_source})
  target_link_libraries(${tool} PRIVATE cbmv cbmv_tool_support CLI11::CLI11)
  list(APPEND CBMV_TOOLS ${tool})
endforeach()
foreach(tool cbmv_eval cbmv_train cbmv_tune)
  target_link_libraries(${tool} PRIVATE cbmv_training)
endforeach()

# cbmv_eval looks for the program that makes its page beside itself.
add_custom_command(TARGET cbmv_eval POST_BUILD
                   COMMAND ${CMAKE_COMMAND} -E create_symlink
                           ${PROJECT_SOURCE_DIR}/scripts/evaluation_report
                           $<TARGET_FILE_DIR:cbmv_eval>/cbmv_evaluation_report)
