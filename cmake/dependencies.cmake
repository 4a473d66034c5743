# Finds the libraries. All that are missing are named in one message, each with the Debian package that brings it.
set(DCEM_MISSING "")

function(dcem_find_library package target debian_package)
  if(NOT TARGET ${target})
    find_package(${package} ${ARGN} QUIET)
  endif()
  if(NOT TARGET ${target})
    set(DCEM_MISSING "${DCEM_MISSING}\n  ${package} not found: apt install ${debian_package}" PARENT_SCOPE)
  endif()
endfunction()

find_package(Threads REQUIRED)
dcem_find_library(glm glm::glm libglm-dev CONFIG)

if(DCEM_BUILD_IO)
  # The double one: single precision would round the coordinates of a city to centimetres.
  dcem_find_library(tinyobjloader tinyobjloader::tinyobjloader_double libtinyobjloader-dev CONFIG)
  dcem_find_library(nlohmann_json nlohmann_json::nlohmann_json nlohmann-json3-dev CONFIG)
  # CMake's own modules: the targets that they define have the same names everywhere.
  dcem_find_library(EXPAT EXPAT::EXPAT libexpat1-dev MODULE)
  dcem_find_library(ZLIB ZLIB::ZLIB zlib1g-dev MODULE)
  list(APPEND CMAKE_MODULE_PATH "${CMAKE_CURRENT_LIST_DIR}")  # FindLibZip.cmake
  dcem_find_library(LibZip libzip::zip libzip-dev MODULE)
  find_path(DCEM_STB_INCLUDE_DIR stb/stb_image_write.h)
  mark_as_advanced(DCEM_STB_INCLUDE_DIR)
  if(NOT DCEM_STB_INCLUDE_DIR)
    string(APPEND DCEM_MISSING "\n  stb/stb_image_write.h not found: apt install libstb-dev")
  endif()
endif()
if(DCEM_BUILD_EXAMPLES)
  dcem_find_library(CLI11 CLI11::CLI11 libcli11-dev CONFIG)
endif()
if(DCEM_BUILD_TESTS)
  dcem_find_library(doctest doctest::doctest doctest-dev CONFIG)
  find_package(Python3 COMPONENTS Interpreter QUIET)
  if(NOT Python3_Interpreter_FOUND)
    string(APPEND DCEM_MISSING "\n  Python 3 not found: apt install python3")
  endif()
endif()

if(DCEM_MISSING)
  message(FATAL_ERROR "DCEM needs what is not installed here:${DCEM_MISSING}")
endif()
