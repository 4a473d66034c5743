# GEOS through its C interface: defines the target geos::geos_c.
#
# Used by DCEM's own build and, installed beside dcemConfig.cmake, by projects that link dcem::io.
find_path(Geos_INCLUDE_DIR geos_c.h)
find_library(Geos_LIBRARY geos_c)
mark_as_advanced(Geos_INCLUDE_DIR Geos_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Geos REQUIRED_VARS Geos_LIBRARY Geos_INCLUDE_DIR)

if(Geos_FOUND AND NOT TARGET geos::geos_c)
  add_library(geos::geos_c UNKNOWN IMPORTED)
  set_target_properties(geos::geos_c PROPERTIES IMPORTED_LOCATION "${Geos_LIBRARY}"
                                                INTERFACE_INCLUDE_DIRECTORIES "${Geos_INCLUDE_DIR}")
endif()
