# Targets for GoogleTest and GoogleMock: `cbmv_gtest`, and `cbmv_gtest_main` with a main function.
add_library(cbmv_gtest INTERFACE)
target_include_directories(cbmv_gtest SYSTEM INTERFACE ${CBMV_GMOCK_INCLUDE_DIR})
target_link_libraries(cbmv_gtest INTERFACE ${CBMV_gmock_LIBRARY} ${CBMV_gtest_LIBRARY} Threads::Threads)
add_library(cbmv_gtest_main INTERFACE)
target_link_libraries(cbmv_gtest_main INTERFACE ${CBMV_gtest_main_LIBRARY} cbmv_gtest)
