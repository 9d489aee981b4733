# GoogleTest and GoogleMock: `cbmv_gtest`, and `cbmv_gtest_main` with a main function. The libraries are
# static; as targets, they are linked in front of what they need.
function(cbmv_import_gtest library)
  add_library(cbmv_${library}_import UNKNOWN IMPORTED)
  set_target_properties(cbmv_${library}_import PROPERTIES IMPORTED_LOCATION ${CBMV_${library}_LIBRARY}
                        INTERFACE_LINK_LIBRARIES "${ARGN}")
endfunction()
cbmv_import_gtest(gtest Threads::Threads)
cbmv_import_gtest(gmock cbmv_gtest_import)
cbmv_import_gtest(gtest_main cbmv_gtest_import)

add_library(cbmv_gtest INTERFACE)
target_include_directories(cbmv_gtest SYSTEM INTERFACE ${CBMV_GMOCK_INCLUDE_DIR})
target_link_libraries(cbmv_gtest INTERFACE cbmv_gmock_import)
add_library(cbmv_gtest_main INTERFACE)
target_link_libraries(cbmv_gtest_main INTERFACE cbmv_gtest_main_import cbmv_gtest)
