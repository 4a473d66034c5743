# libosmium and protozero, headers alone, as far as reading PBF takes them: defines the target osmium::pbf.
find_path(Osmium_INCLUDE_DIR osmium/io/pbf_input.hpp)
find_path(Protozero_INCLUDE_DIR protozero/pbf_reader.hpp)
mark_as_advanced(Osmium_INCLUDE_DIR Protozero_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Osmium REQUIRED_VARS Osmium_INCLUDE_DIR Protozero_INCLUDE_DIR)

if(Osmium_FOUND AND NOT TARGET osmium::pbf)
  add_library(osmium::pbf INTERFACE IMPORTED)
  set_target_properties(osmium::pbf PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${Osmium_INCLUDE_DIR};${Protozero_INCLUDE_DIR}")
  target_link_libraries(osmium::pbf INTERFACE Threads::Threads ZLIB::ZLIB)
endif()
