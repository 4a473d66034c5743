#include <optional>

#include "dcem/io/src/geo/utm.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"

namespace dcem::io {

namespace {

UtmFrame read_utm(const JsonObject& geo) {
  const JsonValue crs = geo.at("crs");
  const std::optional<UtmZone> zone = utm_zone_named(crs.line());
  if (!zone) crs.fail("no zone of UTM; expected one from \"utm1n\" to \"utm60n\", or \"utm1s\" to \"utm60s\"");
  if (!knows_utm()) crs.fail(std::string(no_utm) + "; expected " + std::string(utm_expected));
  const std::vector<JsonValue> offset = geo.at("offset_m").elements();
  return {zone->number, zone->is_north, {offset[0].number(), offset[1].number()}};
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
