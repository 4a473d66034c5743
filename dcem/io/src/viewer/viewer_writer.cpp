#include "dcem/io/viewer_writer.hpp"

#include <stdexcept>
#include <utility>

#include "dcem/io/src/viewer/viewer_frames.hpp"
#include "dcem/io/src/viewer/viewer_page.hpp"

namespace dcem::io {

bool viewer_is_built_in() {
  return !viewer_three().empty();
}

ViewerWriter::ViewerWriter(OutputFolder& folder, const Scene& scene, ViewerFacts facts, const ViewerSettings& settings)
    : file_(folder.open("viewer.html")),
      scene_(scene),
      facts_(std::move(facts)),
      frames_(std::make_unique<ViewerFrames>(facts_.map_values_per_frame, settings)) {
  if (!viewer_is_built_in())
    throw std::invalid_argument("viewer: this build has none; expected three.js at build time");
}

ViewerWriter::~ViewerWriter() = default;

void ViewerWriter::add(const Frame& frame, const FrameResult& result) {
  frames_->add(scene_, frame, result);
}

void ViewerWriter::add(std::span<const RadioMap> maps, const CombinedMap& combined, bool has_noise) {
  frames_->add(maps, combined, has_noise);
}

std::vector<std::string> ViewerWriter::finish(std::vector<std::string> notes) {
  facts_.notes = std::move(notes);
  write_viewer_page(file_, scene_, facts_, *frames_);
  file_.close();
  return frames_->notices();
}

}  // namespace dcem::io
