# Install paths: catkin's layout with ROS, the standard layout without.
if(CBMV_BUILD_ROS)
  set(library_destination ${CATKIN_PACKAGE_LIB_DESTINATION})
  set(program_destination ${CATKIN_PACKAGE_BIN_DESTINATION})
  set(share_destination ${CATKIN_PACKAGE_SHARE_DESTINATION})
  set(config_destination ${share_destination}/cmake)
  set(installed_targets cbmv_stereo_nodelets cbmv_stereo_node ${CBMV_TOOLS})
else()
  set(library_destination ${CMAKE_INSTALL_LIBDIR})
  set(program_destination ${CMAKE_INSTALL_BINDIR})
  set(share_destination ${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME})
  set(config_destination ${library_destination}/cmake/${PROJECT_NAME})
  set(installed_targets ${CBMV_TOOLS})
endif()

# Relative paths: programs find the libraries even if the installed tree is moved.
file(RELATIVE_PATH libraries_from_programs /${program_destination} /${library_destination})
set_target_properties(cbmv ${installed_targets} PROPERTIES
                      INSTALL_RPATH "$ORIGIN;$ORIGIN/${libraries_from_programs}")

install(TARGETS cbmv EXPORT cbmv_stereo-targets LIBRARY DESTINATION ${library_destination})
install(TARGETS ${installed_targets}
        LIBRARY DESTINATION ${library_destination}
        RUNTIME DESTINATION ${program_destination})
install(DIRECTORY include/${PROJECT_NAME} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY models config DESTINATION ${share_destination})
if(CBMV_WITH_TRAINING)
  install(PROGRAMS scripts/evaluation_report DESTINATION ${program_destination}
          RENAME cbmv_evaluation_report)
endif()
if(CBMV_BUILD_ROS)
  install(PROGRAMS scripts/comparison_relay DESTINATION ${program_destination})
  install(DIRECTORY launch DESTINATION ${share_destination})
  install(FILES nodelet_plugins.xml DESTINATION ${share_destination})
endif()

# Files for find_package(cbmv_stereo). catkin generates its own, which include cbmv_stereo-extras.cmake.
export(EXPORT cbmv_stereo-targets NAMESPACE cbmv:: FILE ${PROJECT_BINARY_DIR}/cbmv_stereo-targets.cmake)
install(EXPORT cbmv_stereo-targets NAMESPACE cbmv:: DESTINATION ${config_destination})
if(NOT CBMV_BUILD_ROS)
  include(CMakePackageConfigHelpers)
  configure_package_config_file(cmake/cbmv_stereoConfig.cmake.in ${PROJECT_BINARY_DIR}/cbmv_stereoConfig.cmake
                                INSTALL_DESTINATION ${config_destination} PATH_VARS share_destination)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/cbmv_stereoConfigVersion.cmake
                                   COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/cbmv_stereoConfig.cmake ${PROJECT_BINARY_DIR}/cbmv_stereoConfigVersion.cmake
          DESTINATION ${config_destination})
endif()
