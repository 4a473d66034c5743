#include <algorithm>
#include <charconv>
#include <optional>

#include "dcem/io/src/scenario/scenario_parts.hpp"

namespace dcem::io {

namespace {

/// "utm32n", "utm5s".
std::optional<UtmFrame> utm_zone(const std::string& crs) {
  const std::string start = "utm";
  if (crs.size() < 5 || crs.compare(0, start.size(), start) != 0 || (crs.back() != 'n' && crs.back() != 's')) return {};
  UtmFrame frame;
  const char* const end = crs.data() + crs.size() - 1;
  const auto [rest, error] = std::from_chars(crs.data() + start.size(), end, frame.zone);
  if (error != std::errc{} || rest != end || frame.zone < 1 || frame.zone > 60) return {};
  frame.northern = crs.back() == 'n';
  return frame;
}

UtmFrame read_utm(const JsonObject& geo) {
  const JsonValue crs = geo.at("crs");
  auto frame = utm_zone(crs.line());
  if (!frame) crs.fail("no zone of UTM; expected one from \"utm1n\" to \"utm60n\", or \"utm1s\" to \"utm60s\"");
  if (!knows_utm()) crs.fail(std::string(no_utm) + "; expected " + std::string(utm_expected));
  const std::vector<JsonValue> offset = geo.at("offset_m").elements();
  frame->offset_m = {offset[0].number(), offset[1].number()};
  return *frame;
}

}  // namespace

std::optional<GeoAnchor> read_geo(const JsonObject& scenario) {
  const auto value = scenario.find("geo");
  if (!value) return std::nullopt;
  const JsonObject geo = value->object();
  if (geo.has("crs") != geo.has("offset_m")) geo.fail("crs and offset_m go together; expected both or neither");
  if (geo.has("origin_lat_deg") != geo.has("origin_lon_deg")) {
    geo.fail("origin_lat_deg and origin_lon_deg go together; expected both or neither");
  }
  std::optional<GeoAnchor> origin;
  if (geo.has("origin_lat_deg")) {
    origin = GeoOrigin{geo.at("origin_lat_deg").number(), geo.at("origin_lon_deg").number()};
  }
  // Whoever gives both means the map projection: the origin alone cannot know it.
  if (geo.has("crs")) {
    const UtmFrame frame = read_utm(geo);
    reported_at(*value, [&] { place_on_earth(frame, 0.0, 0.0); });
    return frame;
  }
  if (origin) return origin;
  geo.fail("no place; expected origin_lat_deg and origin_lon_deg, or crs and offset_m");
}

}  // namespace dcem::io
