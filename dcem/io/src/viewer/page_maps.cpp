#include "dcem/io/src/viewer/page_maps.hpp"

#include <array>
#include <cstdint>
#include <string_view>

namespace dcem::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view word_of(MapQuantity quantity) {
  constexpr std::array<std::string_view, 4> words{"power", "best_server", "sinr", "sir"};
  return words[static_cast<std::size_t>(quantity)];
}

}  // namespace

PageMaps::PageMaps(const ViewerFrames& frames, const Vec3& centre_m) : centre_m_(centre_m) {
  arrays_.announce({"map_obstructed"}, {"map_values", "map_points"});
  for (std::size_t place = 0; place < frames.frames().size(); ++place) {
    for (const ViewedMap& map : frames.frames()[place].maps) add(map, place);
  }
  arrays_.counts("map_obstructed").add(bits_);
}

void PageMaps::add(const ViewedMap& map, std::size_t frame) {
  Json entry{{"places", map.places}, {"frame", frame}};
  entry.update(places_of(map));
  entry["first_obstructed"] = obstructed_;
  entry["layers"] = layers_of(map);
  maps_.push_back(std::move(entry));
  for (const bool obstructed : map.obstructed) add_obstructed(obstructed);
}

Json PageMaps::places_of(const ViewedMap& map) {
  if (!map.raster) return {{"points", map.points_m.size()}, {"first_point", first_point_of(map)}};
  const Vec3 corner_m = map.raster->corner_m - centre_m_;
  return {{"corner_m", {corner_m.x, corner_m.y, corner_m.z}},
          {"spacing_m", map.raster->spacing_m},
          {"columns", map.raster->columns},
          {"rows", map.raster->rows}};
}

Json PageMaps::layers_of(const ViewedMap& map) {
  Json layers = Json::array();
  for (const ViewedLayer& layer : map.layers) {
    Json entry{{"shows", word_of(layer.quantity)}, {"first", values_}};
    if (layer.quantity == MapQuantity::power) entry["tx"] = layer.transmitter;
    layers.push_back(std::move(entry));
    for (const float value : layer.values) arrays_.numbers("map_values").number(value);
    values_ += layer.values.size();
  }
  return layers;
}

/// The points of a list stand once, as long as they stay where they are.
std::size_t PageMaps::first_point_of(const ViewedMap& map) {
  auto& [first, points_m] = lists_[map.places];
  if (points_m == map.points_m) return first;
  first = list_points_;
  points_m = map.points_m;
  list_points_ += points_m.size();
  for (const Vec3& point_m : points_m) arrays_.numbers("map_points").add(point_m - centre_m_);
  return first;
}

/// A bit each, the lowest one first.
void PageMaps::add_obstructed(bool obstructed) {
  if (obstructed) bits_ |= 1U << (obstructed_ % 32);
  if (++obstructed_ % 32 == 0) arrays_.counts("map_obstructed").add(std::exchange(bits_, 0));
}

}  // namespace dcem::io
