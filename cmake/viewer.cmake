# The page of results (viewer.html): its own files and three.js become sources of dcem::io. Without three.js the library is
# built without a viewer, and the output key `html` is refused.
if(DCEM_VIEWER)
  find_file(DCEM_THREE_JS three.min.js PATHS /usr/share/javascript/three /usr/local/share/javascript/three
            PATH_SUFFIXES build)
endif()
mark_as_advanced(DCEM_THREE_JS)
set(three_js "")
if(DCEM_VIEWER AND DCEM_THREE_JS)
  set(three_js "${DCEM_THREE_JS}")
else()
  message(STATUS "No three.js: built without the viewer (apt install libjs-three)")
endif()

function(dcem_embed_files target function_name)
  set(source "${CMAKE_CURRENT_BINARY_DIR}/embedded/${function_name}.cpp")
  list(JOIN ARGN "|" files)
  add_custom_command(OUTPUT "${source}"
    COMMAND "${CMAKE_COMMAND}" "-DOUT=${source}" "-DFUNCTION=${function_name}" "-DFILES=${files}"
            -P "${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake"
    DEPENDS ${ARGN} "${PROJECT_SOURCE_DIR}/cmake/embed_files.cmake"
    VERBATIM)
  target_sources(${target} PRIVATE "${source}")
endfunction()

set(viewer_dir "${PROJECT_SOURCE_DIR}/dcem/io/viewer")
dcem_embed_files(dcem_io viewer_html "${viewer_dir}/viewer.html")
dcem_embed_files(dcem_io viewer_style "${viewer_dir}/viewer.css")
# One script, in this order: what a file uses when the page is read stands before it.
set(scripts "")
foreach(part IN ITEMS text data moment colours angles surfaces lines camera rays ray_controls maps map_controls pointer
                      overlay profile panel player)
  list(APPEND scripts "${viewer_dir}/viewer_${part}.js")
endforeach()
dcem_embed_files(dcem_io viewer_script ${scripts} "${viewer_dir}/viewer.js")
dcem_embed_files(dcem_io viewer_three ${three_js})
