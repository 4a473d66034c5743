#pragma once
/// How a `BasicSimulator` makes maps; included by basic_simulator.hpp.
#include <algorithm>

#include "dcem/paths/query/embedded_edges.hpp"
#include "dcem/sim/basic_simulator.hpp"

namespace dcem {

template <SurfaceModel Surface, SpatialIndex Index>
RadioMapPoint BasicSimulator<Surface, Index>::map_point(const LinkResult& link, const Vec3& position_m) {
  RadioMapPoint point{position_m, false, link.statistics, {}};
  const auto strongest = std::max_element(
      link.paths.begin(), link.paths.end(),
      [](const PathContribution& a, const PathContribution& b) { return a.power_ratio < b.power_ratio; });
  if (strongest != link.paths.end()) point.strongest_kinds = kinds(strongest->path);
  return point;
}

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<RadioMap> BasicSimulator<Surface, Index>::radio_maps(const ReceiverGrid& grid,
                                                                 const std::function<void(std::size_t)>& progress,
                                                                 WorkCounters* work) const {
  // Looking at an edge costs several microseconds; in a city it saves about a tenth of a millisecond per point.
  const bool looks_for_embedded = settings_.share_map_work && diffraction_order(settings_.propagation) > 0 &&
                                  grid.size() >= scene_.wedges().size() / 10;
  TransmitterEnds transmitters =
      transmitter_ends({}, {}, looks_for_embedded ? embedded_edges(scene_, index_, *pool_) : std::vector<char>{});
  // Maps hold no channel between elements, and their powers are those of one: none is computed.
  for (RadioEnd& end : transmitters.radio) end.antenna.array = {};
  ReceiverGrid single = grid;
  single.antenna.array = {};
  const Tracer tracer(scene_, index_);
  std::vector<Vec3> transmitters_m;
  std::vector<RadioMap> maps;
  for (std::size_t index = 0; index < transmitters.radio.size(); ++index) {
    if (transmitters.link[index]) transmitters_m.push_back(transmitters.radio[index].position_m);
    maps.push_back({grid, scene_.transmitters()[index].id, std::vector<RadioMapPoint>(grid.size())});
  }
  const ObstructionTest<Index> obstruction(tracer, index_, transmitters_m);
  std::vector<WorkCounters> spent(grid.rows());
  std::vector<PathHalf> rooms = rooms_for_halves();
  pool_->for_each(grid.rows(), [&](std::size_t row, unsigned worker) {
    PathHalf* const room = rooms.empty() ? nullptr : &rooms[worker];
    for (std::size_t column = 0; column < grid.columns(); ++column) {
      const std::size_t cell = row * grid.columns() + column;
      const Vec3 position_m = grid_point_m(grid, row, column);
      const bool obstructed = obstruction.obstructed(position_m);
      for (RadioMap& map : maps) map.points[cell] = {position_m, obstructed, {}, {}};
      if (obstructed) continue;
      const Solved solved = solve_receiver(grid_receiver(single, row, column), cell, transmitters, nullptr, room);
      for (const LinkResult& link : solved.links) maps[link.transmitter].points[cell] = map_point(link, position_m);
      spent[row] += solved.work;
    }
    if (progress) progress(grid.columns());
  });
  if (work == nullptr) return maps;
  *work += transmitters.work;
  for (const WorkCounters& one : spent) *work += one;
  return maps;
}

}  // namespace dcem
