# ZoltanConfig.cmake of Debian names scotch development libraries that its package does not depend on,
# so the library is found directly.
find_path(Zoltan_INCLUDE_DIR zoltan.h PATH_SUFFIXES trilinos)
find_library(Zoltan_LIBRARY NAMES trilinos_zoltan)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Zoltan REQUIRED_VARS Zoltan_LIBRARY Zoltan_INCLUDE_DIR)
if(Zoltan_FOUND AND NOT TARGET Zoltan::Zoltan)
  add_library(Zoltan::Zoltan UNKNOWN IMPORTED GLOBAL)
  set_target_properties(Zoltan::Zoltan PROPERTIES
    IMPORTED_LOCATION "${Zoltan_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${Zoltan_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES MPI::MPI_CXX)
endif()
