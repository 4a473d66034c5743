# Run by ctest with -P. Builds the project in consumer/ in an empty folder and runs what it made.
#   MODE=installed        against an installed DCEM, by find_package
#   MODE=subdirectory     with DCEM's sources, by add_subdirectory, where GLM is the only library that can be found
#   MODE=missing_library  where no library can be found: configuring must fail and name the Debian packages
cmake_minimum_required(VERSION 3.22)
file(REMOVE_RECURSE "${WORK_DIR}")
file(MAKE_DIRECTORY "${WORK_DIR}")

function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY "${WORK_DIR}" RESULT_VARIABLE status OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  message("${output}")
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "failed (${status}): ${ARGN}")
  endif()
endfunction()

set(configure "${CMAKE_COMMAND}" -G "${GENERATOR}" "-DCMAKE_CXX_COMPILER=${CXX_COMPILER}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
              "-DCMAKE_BUILD_TYPE=${BUILD_TYPE}" -B "${WORK_DIR}/build")
set(consumer -S "${CMAKE_CURRENT_LIST_DIR}/consumer")
foreach(library IN ITEMS tinyobjloader nlohmann_json EXPAT ZLIB LibZip CLI11 doctest Python3)
  list(APPEND hide_all_but_glm "-DCMAKE_DISABLE_FIND_PACKAGE_${library}=ON")
endforeach()

if(MODE STREQUAL "missing_library")
  execute_process(COMMAND ${configure} -S "${DCEM_SOURCE_DIR}" ${hide_all_but_glm} -DCMAKE_DISABLE_FIND_PACKAGE_glm=ON
                  RESULT_VARIABLE status ERROR_VARIABLE output OUTPUT_QUIET)
  message("${output}")
  if(status EQUAL 0)
    message(FATAL_ERROR "configuring succeeded without any library")
  endif()
  foreach(debian_package IN ITEMS libglm-dev libtinyobjloader-dev nlohmann-json3-dev libexpat1-dev zlib1g-dev libzip-dev libcli11-dev
                                  doctest-dev python3)
    if(NOT output MATCHES "apt install ${debian_package}")
      message(FATAL_ERROR "the message does not name ${debian_package}")
    endif()
  endforeach()
  return()
endif()

if(MODE STREQUAL "installed")
  run("${CMAKE_COMMAND}" --install "${DCEM_BINARY_DIR}" --prefix "${WORK_DIR}/prefix")
  run(${configure} ${consumer} "-DCMAKE_PREFIX_PATH=${WORK_DIR}/prefix")
else()
  run(${configure} ${consumer} "-DDCEM_SUBDIRECTORY=${DCEM_SOURCE_DIR}" -DDCEM_BUILD_IO=OFF ${hide_all_but_glm})
endif()
cmake_host_system_information(RESULT processors QUERY NUMBER_OF_LOGICAL_CORES)
run("${CMAKE_COMMAND}" --build "${WORK_DIR}/build" --parallel "${processors}")
run("${WORK_DIR}/build/uses_headers")
run("${WORK_DIR}/build/uses_engine")
if(MODE STREQUAL "installed")
  run("${WORK_DIR}/build/uses_io")
endif()
