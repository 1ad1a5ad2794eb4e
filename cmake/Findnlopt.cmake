# Defines nlopt::nlopt. NLopt's own CMake package adds a definition to every file that is compiled.
find_path(nlopt_INCLUDE_DIR nlopt.h)
find_library(nlopt_LIBRARY nlopt)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(nlopt REQUIRED_VARS nlopt_LIBRARY nlopt_INCLUDE_DIR)
if(nlopt_FOUND AND NOT TARGET nlopt::nlopt)
  add_library(nlopt::nlopt UNKNOWN IMPORTED)
  set_target_properties(nlopt::nlopt PROPERTIES
    IMPORTED_LOCATION ${nlopt_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${nlopt_INCLUDE_DIR})
endif()
