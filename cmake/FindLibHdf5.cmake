# HDF5's library for C: defines the target hdf5::hdf5. CMake's own module asks for a compiler of C.
#
# Used by DCEM's own build and, installed beside dcemConfig.cmake, by projects that link dcem::io.
find_path(LibHdf5_INCLUDE_DIR hdf5.h PATH_SUFFIXES hdf5/serial)
find_library(LibHdf5_LIBRARY NAMES hdf5_serial hdf5 PATH_SUFFIXES hdf5/serial)
mark_as_advanced(LibHdf5_INCLUDE_DIR LibHdf5_LIBRARY)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(LibHdf5 REQUIRED_VARS LibHdf5_LIBRARY LibHdf5_INCLUDE_DIR)

if(LibHdf5_FOUND AND NOT TARGET hdf5::hdf5)
  add_library(hdf5::hdf5 UNKNOWN IMPORTED)
  set_target_properties(hdf5::hdf5 PROPERTIES IMPORTED_LOCATION "${LibHdf5_LIBRARY}"
                                              INTERFACE_INCLUDE_DIRECTORIES "${LibHdf5_INCLUDE_DIR}")
endif()
