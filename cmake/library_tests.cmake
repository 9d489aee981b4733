# Tests of the library from the view of an application.

# Each public header compiles by itself.
file(GLOB public_headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}/include
     ${PROJECT_SOURCE_DIR}/include/${PROJECT_NAME}/*.h)
set(header_sources)
foreach(header ${public_headers})
  get_filename_component(name ${header} NAME_WE)
  set(header_source ${PROJECT_BINARY_DIR}/test/public_headers/${name}.cpp)
  file(GENERATE OUTPUT ${header_source} CONTENT "#include \"${header}\"\n")
  list(APPEND header_sources ${header_source})
endforeach()
add_library(public_headers OBJECT EXCLUDE_FROM_ALL ${header_sources})
target_link_libraries(public_headers PRIVATE cbmv::cbmv)
target_include_directories(public_headers SYSTEM PRIVATE ${OpenCV_INCLUDE_DIRS})
add_dependencies(tests public_headers)

# Checks that only declarations of the public headers are exported.
add_test(NAME symbols_test COMMAND ${PROJECT_SOURCE_DIR}/test/scripts/symbols_test.py $<TARGET_FILE:cbmv>)

# Builds the program of docs/cpp.md against the installed tree only.
add_test(NAME consumer_test COMMAND ${PROJECT_SOURCE_DIR}/test/consumer/consumer_test
         ${PROJECT_BINARY_DIR} ${CMAKE_CXX_COMPILER})
