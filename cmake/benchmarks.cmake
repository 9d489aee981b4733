# The program `cbmv_benchmark` (benchmark/), and a test that checks the results of the timed code.

# Google Benchmark before 1.6 cannot add lines to the header of its output.
include(CheckCXXSourceCompiles)
set(CMAKE_REQUIRED_LIBRARIES benchmark::benchmark)
check_cxx_source_compiles("#include <benchmark/benchmark.h>
int main() { benchmark::AddCustomContext(\"key\", \"value\"); }" CBMV_BENCHMARK_HAS_CONTEXT)
unset(CMAKE_REQUIRED_LIBRARIES)

file(GLOB benchmark_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/benchmark/*.cpp)
add_executable(cbmv_benchmark EXCLUDE_FROM_ALL ${benchmark_sources})
# The vector code includes itself once per instruction set, with its path relative to benchmark.
target_include_directories(cbmv_benchmark PRIVATE ${PROJECT_SOURCE_DIR}/benchmark
                           ${PROJECT_SOURCE_DIR}/test)
target_compile_definitions(cbmv_benchmark PRIVATE CBMV_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                           ${CBMV_HIGHWAY_OPTIONS} $<$<BOOL:${CBMV_BENCHMARK_HAS_CONTEXT}>:CBMV_BENCHMARK_CONTEXT>)
target_link_libraries(cbmv_benchmark PRIVATE cbmv_tool_support cbmv_evaluation hwy::hwy benchmark::benchmark)
if(CBMV_WITH_TESTS)
  add_dependencies(tests cbmv_benchmark)
  add_test(NAME benchmark_smoke_test
           COMMAND cbmv_benchmark "--benchmark_filter=^(stage|cbmv|opencv)/.*/320x240x32" --benchmark_min_time=0.001)
  set_tests_properties(benchmark_smoke_test PROPERTIES FAIL_REGULAR_EXPRESSION "ERROR OCCURRED")
endif()
