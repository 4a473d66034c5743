#include <algorithm>
#include <array>
#include <cmath>

#include "dcem/io/src/pictures/heat_map_plan.hpp"

namespace dcem::io::detail {
namespace {

constexpr int far_rows = 3;                  // of labels above and below, where all that is near is taken
constexpr std::size_t most_labelled = 1000;  // more would not fit, and the search for room takes the square of them

// The first free place beside the marker: right, left, above, below, then the four corners.
std::optional<PixelRect> near_plate(PixelPoint centre, const PixelRect& size, const TakenPlaces& places) {
  const PixelRect marker = marker_area(centre);
  const int x = static_cast<int>(centre.x), y = static_cast<int>(centre.y), width = size.width, height = size.height;
  const std::array<std::array<int, 2>, 8> corners{{{marker.right() + 2, y - height / 2},
                                                   {marker.x - 2 - width, y - height / 2},
                                                   {x - width / 2, marker.y - 2 - height},
                                                   {x - width / 2, marker.bottom() + 2},
                                                   {marker.right(), marker.y - height},
                                                   {marker.right(), marker.bottom()},
                                                   {marker.x - width, marker.y - height},
                                                   {marker.x - width, marker.bottom()}}};
  for (const auto& corner : corners) {
    const PixelRect area{corner[0], corner[1], width, height};
    if (places.is_free(area)) return area;
  }
  return std::nullopt;
}

// The same in rows further up and down: over the marker, or to its right or left.
std::optional<PixelRect> far_plate(PixelPoint centre, const PixelRect& size, const TakenPlaces& places) {
  const PixelRect marker = marker_area(centre);
  const int x = static_cast<int>(centre.x), pitch = size.height + label_padding_px;
  for (int row = 1; row <= far_rows; ++row) {
    for (const int y : {marker.y - 2 - size.height - row * pitch, marker.bottom() + 2 + row * pitch}) {
      for (const int left : {x - size.width / 2, x, x - size.width}) {
        const PixelRect area{left, y, size.width, size.height};
        if (places.is_free(area)) return area;
      }
    }
  }
  return std::nullopt;
}

// At a corner of a symbol a label may be as near to the next symbol.
bool is_at_corner(PixelPoint centre, const PixelRect& plate) {
  const bool is_level = centre.y > plate.y && centre.y < plate.bottom();
  return !is_level && (centre.x < plate.x || centre.x > plate.right());
}

void place_label(SeenMarker& marker, TakenPlaces& places) {
  if (marker.label.empty()) return;
  const PixelRect size = plate_about(marker.centre, marker.label, label_style);
  marker.plate = near_plate(marker.centre, size, places);
  marker.is_led = !marker.plate || is_at_corner(marker.centre, *marker.plate);
  if (!marker.plate) marker.plate = far_plate(marker.centre, size, places);
  if (marker.plate) places.take(*marker.plate);
}

// The place lies in the plot.
bool is_inside(const PixelRect& plot, PixelPoint place) {
  return place.x >= plot.x && place.x < plot.right() && place.y >= plot.y && place.y < plot.bottom();
}

}  // namespace

bool TakenPlaces::is_free(const PixelRect& area) const {
  return intersection(area, plot_) == area && std::none_of(taken_.begin(), taken_.end(), [&](const PixelRect& other) {
           const PixelRect shared = intersection(area, other);
           return shared.width > 0 && shared.height > 0;
         });
}

PixelRect marker_area(PixelPoint centre) {
  const int reach = static_cast<int>(marker_radius_px) + 4;
  return {static_cast<int>(centre.x) - reach, static_cast<int>(centre.y) - reach, 2 * reach, 2 * reach};
}

PixelRect plate_about(PixelPoint middle, const std::string& text, const TextStyle& style) {
  const int width = static_cast<int>(std::ceil(text_width_px(text, style))) + 2 * label_padding_px;
  const int height = static_cast<int>(style.size_px) + label_padding_px;
  return {static_cast<int>(middle.x) - width / 2, static_cast<int>(middle.y) - height / 2, width, height};
}

std::vector<SeenMarker> seen_markers(const HeatMap& map, const HeatMapLayout& layout) {
  TakenPlaces places(layout.plot);
  std::vector<SeenMarker> seen;
  for (const HeatMap::Marker& transmitter : map.transmitters) {
    const PixelPoint centre = layout.point(transmitter.x_m, transmitter.y_m);
    if (!is_inside(layout.plot, centre)) continue;
    seen.push_back({centre, fit_text(transmitter.label, label_style, longest_name_px)});
    places.take(marker_area(centre));
  }
  for (std::size_t index = 0; index < std::min(seen.size(), most_labelled); ++index) place_label(seen[index], places);
  return seen;
}

}  // namespace dcem::io::detail
