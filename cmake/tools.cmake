# Command-line programs: src/tools/NAME.cpp becomes NAME, linked with the core, and with the training
# where it trains.
find_package(CLI11 REQUIRED)

set(CBMV_TOOLS)
file(GLOB tool_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/tools/cbmv_*.cpp)
foreach(tool_source ${tool_sources})
  get_filename_component(tool ${tool_source} NAME_WE)
  add_executable(${tool} ${tool_source})
  target_link_libraries(${tool} PRIVATE cbmv CLI11::CLI11)
  list(APPEND CBMV_TOOLS ${tool})
endforeach()
foreach(tool cbmv_eval cbmv_train cbmv_tune)
  target_link_libraries(${tool} PRIVATE cbmv_training)
endforeach()
