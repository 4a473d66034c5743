#include "dcem/io/map_overlay.hpp"

#include <array>

#include "dcem/io/src/exchange/xml_text.hpp"
#include "dcem/io/src/text/number_text.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

/// A file name as a relative URI (RFC 3986): everything but unreserved characters as % and two digits.
std::string uri_of(const std::string& name) {
  constexpr std::string_view hexadecimal = "0123456789ABCDEF", others = "-._~";
  std::string uri;
  for (const char character : name) {
    const auto byte = static_cast<unsigned char>(character);
    const bool is_plain = (byte >= '0' && byte <= '9') || (byte >= 'A' && byte <= 'Z') || (byte >= 'a' && byte <= 'z');
    if (is_plain || others.find(character) != std::string_view::npos) {
      uri.push_back(character);
    } else {
      uri.append({'%', hexadecimal[byte / 16], hexadecimal[byte % 16]});
    }
  }
  return uri;
}

/// What the colours mean.
std::string legend(const HeatMap& map) {
  const std::optional<ValueRange> range = heat_map_layout(map).range;
  if (!map.categories.empty() || !range) return map.title;
  std::string text = map.title + ". " + map.label + " from ";
  append_number(text, range->low);
  text += " (violet) to ";
  append_number(text, range->high);
  return text + " " + map.unit + " (yellow)";
}

/// The corners of the outermost cells, counterclockwise from the lower left.
std::string corners(const HeatMap& map, const GeoAnchor& anchor) {
  const double left_m = map.origin_x_m - 0.5 * map.spacing_x_m, bottom_m = map.origin_y_m - 0.5 * map.spacing_y_m;
  const double right_m = left_m + static_cast<double>(map.columns) * map.spacing_x_m;
  const double top_m = bottom_m + static_cast<double>(map.rows) * map.spacing_y_m;
  std::string text;
  for (const auto& [x_m, y_m] :
       {std::array{left_m, bottom_m}, {right_m, bottom_m}, {right_m, top_m}, {left_m, top_m}}) {
    const GeoPlace place = place_on_earth(anchor, x_m, y_m);
    if (!text.empty()) text += ' ';
    text += format_fixed(place.lon_deg, 9) + "," + format_fixed(place.lat_deg, 9);
  }
  return text;
}

}  // namespace

void write_ground_overlay(AtomicFile& kml, AtomicFile& picture, const HeatMap& map, const GeoAnchor& anchor) {
  draw_cells(map).write_png(picture.stream());
  kml.write(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n"
      "<GroundOverlay>\n<name>" +
      xml_text(map.title) + "</name>\n<description>" + xml_text(legend(map)) +
      "</description>\n<color>b0ffffff</color>\n<Icon><href>" + uri_of(picture.target().filename().string()) +
      "</href></Icon>\n<gx:LatLonQuad><coordinates>" + corners(map, anchor) +
      "</coordinates></gx:LatLonQuad>\n</GroundOverlay>\n</kml>\n");
}

}  // namespace dcem::io
