# Where everything goes: as catkin has it with ROS, as any library without.
include(GNUInstallDirs)
if(CBMV_BUILD_ROS)
  set(library_destination ${CATKIN_PACKAGE_LIB_DESTINATION})
  set(program_destination ${CATKIN_PACKAGE_BIN_DESTINATION})
  set(share_destination ${CATKIN_PACKAGE_SHARE_DESTINATION})
  set(installed_targets cbmv cbmv_training cbmv_stereo_nodelets cbmv_stereo_node ${CBMV_TOOLS} ${CBMV_ROS_TOOLS})
else()
  set(library_destination ${CMAKE_INSTALL_LIBDIR})
  set(program_destination ${CMAKE_INSTALL_BINDIR})
  set(share_destination ${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME})
  set(installed_targets cbmv cbmv_training ${CBMV_TOOLS})
endif()

# Programs find the libraries beside them wherever the tree is moved.
file(RELATIVE_PATH libraries_from_programs /${program_destination} /${library_destination})
set_target_properties(${installed_targets} PROPERTIES
                      INSTALL_RPATH "$ORIGIN;$ORIGIN/${libraries_from_programs}")

install(TARGETS ${installed_targets}
        ARCHIVE DESTINATION ${library_destination}
        LIBRARY DESTINATION ${library_destination}
        RUNTIME DESTINATION ${program_destination})
install(PROGRAMS scripts/evaluation_report DESTINATION ${program_destination}
        RENAME cbmv_evaluation_report)
install(DIRECTORY include/${PROJECT_NAME} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY models config DESTINATION ${share_destination})
if(CBMV_BUILD_ROS)
  install(PROGRAMS scripts/comparison_relay DESTINATION ${program_destination})
  install(DIRECTORY launch DESTINATION ${share_destination})
  install(FILES nodelet_plugins.xml DESTINATION ${share_destination})
endif()
