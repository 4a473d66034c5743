# How DCEM's own targets are compiled. Nothing here reaches a project that uses DCEM.

get_property(is_multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
if(PROJECT_IS_TOP_LEVEL AND NOT is_multi_config AND NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release, RelWithDebInfo or Debug" FORCE)
endif()

function(dcem_enable_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion -Wshadow
                                           $<$<BOOL:${DCEM_WARNINGS_AS_ERRORS}>:-Werror>)
  # GCC 12 warns of overlapping or overlong copies inside std::string where there are none (GCC bugs 105651, 105329; mended
  # in 13).
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow)
  endif()
endfunction()

# Sources share what they include and instantiate. Names in them must not clash: a test file has a namespace of its own.
function(dcem_join_sources target)
  if(DCEM_JOIN_SOURCES)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 20)
  endif()
endfunction()

# One program from one or more sources, in ${CMAKE_BINARY_DIR}/bin.
function(dcem_add_program target)
  add_executable(${target} ${ARGN})
  target_link_libraries(${target} PRIVATE dcem::io)
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")
  dcem_enable_warnings(${target})
endfunction()
