# -DCBMV_SANITIZE=address,undefined or thread builds everything with the sanitizers of gcc or clang. They
# end a program at the first error. docs/reliability.md describes how to run them.
set(CBMV_SANITIZE "" CACHE STRING "Sanitizers: empty, address,undefined or thread")
set_property(CACHE CBMV_SANITIZE PROPERTY STRINGS "" "address,undefined" thread)
if(NOT CBMV_SANITIZE MATCHES "^(address,undefined|thread)?$")
  message(FATAL_ERROR "CBMV_SANITIZE is '${CBMV_SANITIZE}', expected \"address,undefined\", \"thread\" or nothing.")
endif()
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
# -O1 reduces the build time to two thirds. _GLIBCXX_ASSERTIONS enables index checks of the standard library.
add_compile_options(-O1 -g1 -UNDEBUG)
add_compile_definitions(_GLIBCXX_ASSERTIONS)
# With sanitizers, vector code takes minutes per file to build, so only one instruction set is built. It is
# not the emulated one, which takes longest.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  add_compile_options(-mssse3)
endif()
add_compile_definitions(HWY_COMPILE_ONLY_STATIC)

if(sanitizers STREQUAL "thread")
  # Debian's oneTBB is built without ThreadSanitizer, which therefore does not see the synchronization at
  # the begin and end of a parallel loop. The headers in this folder add annotations for it.
  include_directories(BEFORE ${PROJECT_SOURCE_DIR}/test/sanitizers/annotated)
endif()
