# `cmake --install` and find_package(hydrapod): tests/packaging holds a consumer that proves it.
include(CMakePackageConfigHelpers)
install(TARGETS hydrapod EXPORT hydrapodTargets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS hydrapod_cli RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(DIRECTORY include/hydrapod DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/include/hydrapod/base/version.hpp
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/hydrapod/base)
install(DIRECTORY models DESTINATION ${CMAKE_INSTALL_DATADIR}/hydrapod)
install(EXPORT hydrapodTargets NAMESPACE hydrapod:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hydrapod)
configure_package_config_file(cmake/hydrapodConfig.cmake.in hydrapodConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hydrapod)
write_basic_package_version_file(hydrapodConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/hydrapodConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/hydrapodConfigVersion.cmake
              cmake/Findudunits2.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hydrapod)
