#pragma once
/// The part of the page that changes from frame to frame: poses, links and rays. Private to dcem::io.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/io/src/viewer/page_array.hpp"
#include "dcem/io/src/viewer/viewer_frames.hpp"

namespace dcem::io {

class PageFrames {
 public:
  PageFrames(const ViewerFrames& frames, const Vec3& centre_m);

  void describe(nlohmann::ordered_json& head) const;
  void write(AtomicFile& file) const { arrays_.write(file); }

 private:
  void add(const ViewedFrame& frame);
  void add(const ViewedPose& pose);
  void add(const ViewedLink& link);
  void add(const ViewedRay& ray);
  std::uint32_t path_number(const ViewedRay& ray);
  std::uint32_t surface_number(std::uint32_t viewed);

  Vec3 centre_m_;
  const ViewedSurfaces& surfaces_;
  Numbering<std::string> names_;
  Numbering<std::pair<std::string, std::string>> paths_;
  Numbering<std::uint32_t> surface_numbers_;  // of those that the rays of the page touch
  PageArrays arrays_;
};

}  // namespace dcem::io
