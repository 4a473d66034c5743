# Headers, dcem::engine, dcem::io, the program, and the files that find_package(dcem CONFIG [COMPONENTS engine io]) reads.
include(CMakePackageConfigHelpers)
set(package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/dcem")

if(NOT DCEM_BUILD_IO)
  set(headers_left_out PATTERN io EXCLUDE)
endif()
# A directory rather than a FILE_SET: that needs CMake 3.23, and 3.22 is promised. io/src and engine are private.
install(DIRECTORY dcem DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" FILES_MATCHING PATTERN "*.hpp" PATTERN src EXCLUDE
                                                                                    PATTERN engine EXCLUDE
                                                                                    ${headers_left_out})

# Several export sets, so that a project that wants the headers or the engine alone need not have the libraries of dcem::io.
install(TARGETS dcem EXPORT dcemTargets)
install(EXPORT dcemTargets NAMESPACE dcem:: DESTINATION "${package_dir}")
if(DCEM_BUILD_ENGINE)
  install(TARGETS dcem_engine EXPORT dcemEngineTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  install(EXPORT dcemEngineTargets NAMESPACE dcem:: DESTINATION "${package_dir}")
endif()
if(DCEM_BUILD_IO)
  install(TARGETS dcem_io EXPORT dcemIoTargets ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}")
  install(EXPORT dcemIoTargets NAMESPACE dcem:: DESTINATION "${package_dir}")
endif()
if(TARGET dcem_program)
  install(TARGETS dcem_program RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}")
  if(TARGET dcem_man)
    install(FILES "${PROJECT_BINARY_DIR}/examples/dcem.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1")
  endif()
endif()

configure_package_config_file(cmake/dcemConfig.cmake.in "${PROJECT_BINARY_DIR}/dcemConfig.cmake"
                              INSTALL_DESTINATION "${package_dir}")
# Before 1.0 any minor version may change the interface.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/dcemConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/dcemConfig.cmake" "${PROJECT_BINARY_DIR}/dcemConfigVersion.cmake"
        DESTINATION "${package_dir}")
if(DCEM_BUILD_IO)
  install(FILES cmake/FindLibZip.cmake cmake/FindCairo.cmake cmake/FindMatio.cmake cmake/FindGeographicLib.cmake
                cmake/FindLibHdf5.cmake cmake/FindGeos.cmake DESTINATION "${package_dir}")
endif()
install(FILES LICENSE docs/scenario_reference.md DESTINATION "${CMAKE_INSTALL_DOCDIR}")
install(FILES data/dcem-scenario-1.schema.json DESTINATION "${CMAKE_INSTALL_DATADIR}/dcem")
