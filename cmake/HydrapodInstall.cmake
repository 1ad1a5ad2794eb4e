# `cmake --install` and find_package(hydrapod): tests/packaging holds a consumer that proves it.
include(CMakePackageConfigHelpers)
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME hydrapod)
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
              cmake/Findnlopt.cmake cmake/Findudunits2.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hydrapod)


# Man pages and the completion of bash, as the program itself prints them.
set(help_folder ${CMAKE_CURRENT_BINARY_DIR}/help)
add_custom_command(OUTPUT ${help_folder}/hydrapod
  COMMAND ${CMAKE_COMMAND} -E make_directory ${help_folder}/man1
  COMMAND hydrapod_cli help --man ${help_folder}/man1
  COMMAND hydrapod_cli help --completion > ${help_folder}/hydrapod
  DEPENDS hydrapod_cli
  COMMENT "Man pages"
  VERBATIM)
add_custom_target(hydrapod_help ALL DEPENDS ${help_folder}/hydrapod)
install(DIRECTORY ${help_folder}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR})
install(FILES ${help_folder}/hydrapod DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)

if(HYDRAPOD_BUILD_PYTHON)
  set(python_folder lib/python3/dist-packages/hydrapod)  # where Debian's interpreter looks
  install(TARGETS python_core DESTINATION ${python_folder} COMPONENT python)
  install(DIRECTORY python/hydrapod/ DESTINATION ${python_folder} COMPONENT python
    FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed")
endif()

# scripts/package.sh: one Debian package for program, library and models, one for Python. Their
# dependencies are those of their binaries.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_PACKAGE_CONTACT "The hydrapod authors <hydrapod@invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_HYDRAPOD_PACKAGE_NAME hydrapod)
set(CPACK_DEBIAN_HYDRAPOD_PACKAGE_RECOMMENDS gnuplot-nox)
string(JOIN ", " CPACK_DEBIAN_HYDRAPOD_PACKAGE_SUGGESTS libeigen3-dev libfmt-dev nlohmann-json3-dev
  libtomlplusplus-dev libudunits2-dev libsundials-dev libceres-dev libnlopt-dev libhdf5-dev zlib1g-dev
  libssl-dev)
set(CPACK_DEBIAN_MPI_PACKAGE_NAME hydrapod-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS "hydrapod (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-hydrapod)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3 (<< 3.12), python3-numpy")
include(CPack)
