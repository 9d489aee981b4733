# -DCBMV_SANITIZE=address,undefined or thread: everything is built with gcc's or clang's sanitizers,
# which end a program at the first fault that they see. docs/reliability.md says how to run them.
set(CBMV_SANITIZE "" CACHE STRING "Sanitizers: empty, address,undefined or thread")
set_property(CACHE CBMV_SANITIZE PROPERTY STRINGS "" "address,undefined" thread)
set(sanitizers ${CBMV_SANITIZE})
if(CBMV_BUILD_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "CBMV_BUILD_FUZZERS needs clang: give -DCMAKE_CXX_COMPILER=clang++")
  endif()
  set(sanitizers fuzzer-no-link,address,undefined)
endif()
if(NOT sanitizers)
  return()
endif()

set(sanitizer_flags "-fsanitize=${sanitizers} -fno-sanitize-recover=all -fno-omit-frame-pointer")
string(APPEND CMAKE_CXX_FLAGS " ${sanitizer_flags}")
string(APPEND CMAKE_EXE_LINKER_FLAGS " ${sanitizer_flags}")
string(APPEND CMAKE_SHARED_LINKER_FLAGS " ${sanitizer_flags}")
# Little optimization: two thirds of the time to build. The standard library checks its indices.
add_compile_options(-O1 -g1 -UNDEBUG)
add_compile_definitions(_GLIBCXX_ASSERTIONS)
# Vector code takes minutes a file to build with sanitizers: one instruction set instead of six. Not the
# emulated one, which takes longest.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-mssse3)
endif()
add_compile_definitions(HWY_COMPILE_ONLY_STATIC)

if(sanitizers STREQUAL "thread")
  # Debian's oneTBB is built without the sanitizer, which so does not see that a loop begins after
  # what is before it and ends before what is behind it: the headers there tell it.
  include_directories(BEFORE ${PROJECT_SOURCE_DIR}/test/sanitizers/annotated)
endif()
