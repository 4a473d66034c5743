#pragma once
/// The maps of the page. Private to dcem::io.
#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "dcem/io/src/viewer/page_array.hpp"
#include "dcem/io/src/viewer/viewer_frames.hpp"

namespace dcem::io {

class PageMaps {
 public:
  PageMaps(const ViewerFrames& frames, const Vec3& centre_m);

  void describe(nlohmann::ordered_json& head) const { head["maps"] = maps_; }
  void write(AtomicFile& file) const { arrays_.write(file); }

 private:
  void add(const ViewedMap& map, std::size_t frame);
  nlohmann::ordered_json places_of(const ViewedMap& map);
  nlohmann::ordered_json layers_of(const ViewedMap& map);
  std::size_t first_point_of(const ViewedMap& map);
  void add_obstructed(bool obstructed);

  Vec3 centre_m_;
  nlohmann::ordered_json maps_ = nlohmann::ordered_json::array();
  std::map<std::string, std::pair<std::size_t, std::vector<Vec3>>> lists_;  // by id: the first point, and all of them
  std::size_t list_points_ = 0, values_ = 0, obstructed_ = 0;               // that stand in the page
  std::uint32_t bits_ = 0;
  PageArrays arrays_;
};

}  // namespace dcem::io
