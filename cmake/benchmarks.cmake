# The program `cbmv_benchmark` (benchmark/), and a test that it runs and that what it times is right.

file(GLOB benchmark_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/benchmark/*.cpp)
add_executable(cbmv_benchmark EXCLUDE_FROM_ALL ${benchmark_sources})
# The vector code includes itself once per instruction set, by its path below benchmark.
target_include_directories(cbmv_benchmark PRIVATE ${PROJECT_SOURCE_DIR}/benchmark
                           ${PROJECT_SOURCE_DIR}/test)
target_compile_definitions(cbmv_benchmark PRIVATE CBMV_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                           ${CBMV_HIGHWAY_OPTIONS})
target_link_libraries(cbmv_benchmark PRIVATE cbmv_tool_support cbmv_evaluation hwy::hwy benchmark::benchmark)
if(CBMV_WITH_TESTS)
  add_dependencies(tests cbmv_benchmark)
  add_test(NAME benchmark_smoke_test
           COMMAND cbmv_benchmark "--benchmark_filter=^(stage|cbmv|opencv)/.*/320x240x32" --benchmark_min_time=0.001)
  set_tests_properties(benchmark_smoke_test PROPERTIES FAIL_REGULAR_EXPRESSION "ERROR OCCURRED")
endif()
