#pragma once
/// The page of the viewer as bytes: its own files, three.js, and the results. Private to dcem::io.
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/src/viewer/viewer_frames.hpp"
#include "dcem/io/viewer_writer.hpp"

namespace dcem::io {

/// Files that were put into the library when it was built.
std::string_view viewer_html();
std::string_view viewer_style();
std::string_view viewer_script();
std::string_view viewer_three();  ///< three.js; empty where it was not there

/// Writes the page. Throws `OutputError`.
void write_viewer_page(AtomicFile& file, const Scene& scene, const ViewerFacts& facts, const ViewerFrames& frames);

}  // namespace dcem::io
