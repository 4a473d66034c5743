#include "dcem/io/src/viewer/viewed_map.hpp"

#include <limits>

#include "dcem/io/combined_map_writer.hpp"

namespace dcem::io {
namespace {

float single(const std::optional<double>& value) {
  return value ? static_cast<float>(*value) : std::numeric_limits<float>::quiet_NaN();
}

/// Which points of a map are kept.
std::vector<std::size_t> kept_points(const MapPlaces& places, std::size_t step) {
  std::vector<std::size_t> kept;
  if (!places.is_grid()) {
    for (std::size_t point = 0; point < places.size(); point += step) kept.push_back(point);
    return kept;
  }
  const ReceiverGrid& grid = places.grid();
  for (std::size_t row = 0; row < grid.rows(); row += step) {
    for (std::size_t column = 0; column < grid.columns(); column += step) kept.push_back(row * grid.columns() + column);
  }
  return kept;
}

ViewedRaster raster_of(const ReceiverGrid& grid, std::size_t step) {
  const double factor = static_cast<double>(step);
  const std::array<double, 2> spacing_m{factor * grid.spacing_m[0], factor * grid.spacing_m[1]};
  return {grid.origin_m - 0.5 * Vec3(spacing_m[0], spacing_m[1], 0.0), spacing_m, (grid.columns() + step - 1) / step,
          (grid.rows() + step - 1) / step};
}

/// `value(point)` of those that are kept.
template <typename Value>
void add_layer(ViewedMap& viewed, const std::vector<std::size_t>& kept, MapQuantity quantity, std::size_t transmitter,
               Value&& value) {
  ViewedLayer layer{quantity, transmitter, {}};
  layer.values.reserve(kept.size());
  for (const std::size_t point : kept) layer.values.push_back(single(value(point)));
  viewed.layers.push_back(std::move(layer));
}

void add_powers(ViewedMap& viewed, std::span<const RadioMap> maps, const std::vector<std::size_t>& kept) {
  for (std::size_t transmitter = 0; transmitter < maps.size(); ++transmitter) {
    add_layer(viewed, kept, MapQuantity::power, transmitter, [&](std::size_t index) {
      const RadioMapPoint& point = maps[transmitter].points[index];
      return point.obstructed ? std::nullopt : point.statistics.power_incoherent_dbm;
    });
  }
}

void add_servers(ViewedMap& viewed, const CombinedMap& combined, const std::vector<std::size_t>& kept) {
  add_layer(viewed, kept, MapQuantity::best_server, 0, [&](std::size_t index) {
    const std::optional<std::size_t> server = combined.points[index].server;
    return server ? std::optional(static_cast<double>(*server)) : std::nullopt;
  });
}

}  // namespace

ViewedMap view_of_maps(std::span<const RadioMap> maps, const CombinedMap& combined, bool has_noise, std::size_t step) {
  const MapPlaces& places = maps.front().places;
  const std::vector<std::size_t> kept = kept_points(places, step);
  ViewedMap viewed{places.id(), {}, {}, {}, {}};
  if (places.is_grid()) viewed.raster = raster_of(places.grid(), step);
  for (const std::size_t index : kept) {
    const RadioMapPoint& point = maps.front().points[index];
    viewed.obstructed.push_back(point.obstructed || point.sheltered);
    if (!places.is_grid()) viewed.points_m.push_back(point.position_m);
  }
  add_powers(viewed, maps, kept);
  if (maps.size() > 1) add_servers(viewed, combined, kept);
  if (has_sinr(combined, has_noise)) {
    add_layer(viewed, kept, has_noise ? MapQuantity::sinr : MapQuantity::sir, 0,
              [&](std::size_t index) { return combined.points[index].sinr_db; });
  }
  return viewed;
}

}  // namespace dcem::io
