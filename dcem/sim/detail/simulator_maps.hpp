#pragma once
/// How a `BasicSimulator` makes maps; included by basic_simulator.hpp.
#include <algorithm>

#include "dcem/channel/cell_average.hpp"
#include "dcem/paths/halves/crowd_joiner.hpp"
#include "dcem/paths/halves/crowd_triples.hpp"
#include "dcem/paths/query/scene_contacts.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/list_groups.hpp"
#include "dcem/sim/detail/map_groups.hpp"
#include "dcem/sim/detail/map_progress.hpp"

namespace dcem {

namespace detail {

inline RadioMapPoint map_point(const LinkResult& link, const Vec3& position_m) {
  RadioMapPoint point{position_m, false, link.statistics, {}};
  const auto strongest = std::max_element(
      link.paths.begin(), link.paths.end(),
      [](const PathContribution& a, const PathContribution& b) { return a.power_ratio < b.power_ratio; });
  if (strongest != link.paths.end()) point.strongest_kinds = kinds(strongest->path);
  return point;
}

}  // namespace detail

/// What all points of some maps share where the plan has halves, and what each thread needs.
template <SurfaceModel Surface, SpatialIndex Index>
struct BasicSimulator<Surface, Index>::MapShare {
  /// Sequences by point, then by transmitter.
  using Joined = std::vector<std::vector<SequenceList>>;

  MapShare(const BasicSimulator& simulator, const TransmitterEnds& ends)
      : transmitters(ends),
        search(simulator.search_settings(ends.contacts.known())),
        crowds(std::max(1U, simulator.pool_->size()),
               Crowd(detail::pixels_for_facets(Crowd::default_pixels, simulator.outlines_->size()))),
        beams(joins_triples(search) ? crowds.size() : 0),
        blockers(crowds.size()),
        asked_edges(edges_of_use(simulator.scene_.wedges().size())) {}

  /// The sequences that paths to each of some points may take.
  Joined join(const BasicSimulator& simulator, std::span<const Vec3> points_m, unsigned worker, WorkCounters& work) {
    Joined joined(points_m.size(), std::vector<SequenceList>(transmitters.link.size()));
    const Scene& scene = simulator.scene_;
    const FacetOutlines& outlines = *simulator.outlines_;
    const LaneScene& lanes = *simulator.lanes_;
    HalfSettings seen = half_settings(search);
    seen.asked_edges = asked_edges;
    Crowd& crowd = crowds[worker];
    crowd.look_from(scene, outlines, lanes, points_m, seen);
    if (!beams.empty()) beams[worker].look_from(scene, outlines, lanes, crowd, seen);
    const Tracer tracer(scene, simulator.index_);
    SearchCounters counters;
    for (std::size_t index = 0; index < transmitters.link.size(); ++index) {
      if (!transmitters.link[index]) continue;
      for (std::vector<SequenceList>& of_point : joined) of_point[index].add({});
      CrowdGates<Index> gates(tracer, outlines, lanes, crowd, *transmitters.halves[index].lists(), blockers[worker],
                              counters.solver);
      const auto add = [&](const Sequence& sequence, std::size_t point) { joined[point][index].add(sequence); };
      CrowdJoiner<Index>(gates, joined_orders(search)).for_each_sequence(add);
      if (!beams.empty()) CrowdTriples<Index>(gates, beams[worker], joined_orders(search)).for_each_sequence(add);
    }
    detail::add_search_work(counters, work);
    return joined;
  }

  /// By edge, whether a transmitter lights it; empty where two elements may follow before one does.
  std::vector<char> edges_of_use(std::size_t edges) const {
    if (search.max_diffractions > 1 || !beams.empty()) return {};
    std::vector<char> of_use(edges, 0);
    for (std::size_t index = 0; index < transmitters.link.size(); ++index) {
      if (!transmitters.link[index]) continue;
      const BeamLists& lists = *transmitters.halves[index].lists();
      for (std::uint32_t edge = 0; edge < edges; ++edge)
        if (lists.lights(WedgeId(edge))) of_use[edge] = 1;
    }
    return of_use;
  }

  const TransmitterEnds& transmitters;
  PathSearchSettings search;
  std::vector<Crowd> crowds;
  std::vector<CrowdBeams> beams;  ///< none where no sequences of three elements are joined
  std::vector<Blockers> blockers;
  std::vector<char> asked_edges;
};

/// What is asked of a map: where, how, and the receiver at each point. On a grid, points where none could stand are
/// left out; those of a list are devices, mounted ones among them, and all have values.
template <SurfaceModel Surface, SpatialIndex Index>
struct BasicSimulator<Surface, Index>::MapOrder {
  MapPlaces places;
  std::function<Vec3(std::size_t)> position_m;
  std::function<Device(std::size_t)> receiver;  ///< without an array: maps hold no channel between elements
};

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<RadioMap> BasicSimulator<Surface, Index>::radio_maps(const ReceiverGrid& grid,
                                                                 const std::function<void(std::size_t)>& progress,
                                                                 WorkCounters* work) const {
  if (grid.samples_per_cell() > 1) {
    std::vector<RadioMap> maps = radio_maps(sample_grid(grid), progress, work);
    for (RadioMap& map : maps) map = cell_averages(grid, map);
    return maps;
  }
  ReceiverGrid single = grid;
  single.antenna.array = {};
  const std::size_t columns = grid.columns();
  return solve_map({grid, [&](std::size_t cell) { return grid_point_m(grid, cell / columns, cell % columns); },
                    [&](std::size_t cell) { return grid_receiver(single, cell / columns, cell % columns); }},
                   progress, work);
}

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<RadioMap> BasicSimulator<Surface, Index>::radio_maps(const ReceiverList& list,
                                                                 const std::function<void(std::size_t)>& progress,
                                                                 WorkCounters* work) const {
  const auto position_m = [&](std::size_t point) { return state_of(list.receivers[point]).position_m; };
  const auto receiver = [&](std::size_t point) {
    Device device = list.receivers[point];
    device.antenna.array = {};
    return device;
  };
  return solve_map({{list.id, list.receivers.size()}, position_m, receiver}, progress, work);
}

template <SurfaceModel Surface, SpatialIndex Index>
std::vector<RadioMap> BasicSimulator<Surface, Index>::solve_map(const MapOrder& order,
                                                                const std::function<void(std::size_t)>& progress,
                                                                WorkCounters* work) const {
  const std::size_t size = order.places.size();
  const bool is_grid = order.places.is_grid();
  // Looking at an edge costs several microseconds; in a city it saves about a tenth of a millisecond per point.
  const bool looks_for_contacts =
      settings_.share_map_work && diffraction_order(settings_.propagation) > 0 && size >= scene_.wedges().size() / 10;
  TransmitterEnds transmitters = transmitter_ends(
      scene_.transmitters(), size, {}, {},
      looks_for_contacts ? scene_contacts(scene_, index_, search_settings().edges, *pool_) : SceneContacts{}, true);
  // Maps hold no channel between elements, and their powers are those of one: none is computed.
  for (std::optional<RadioEnd>& end : transmitters.radio) end->antenna.array = {};
  const Tracer tracer(scene_, index_);
  std::vector<Vec3> transmitters_m;
  std::vector<RadioMap> maps;
  for (std::size_t index = 0; index < transmitters.radio.size(); ++index) {
    if (transmitters.link[index]) transmitters_m.push_back(transmitters.radio_of(index).position_m);
    maps.push_back({order.places, scene_.transmitters()[index].id, std::vector<RadioMapPoint>(size)});
  }
  const ObstructionTest<Index> obstruction(tracer, index_, transmitters_m);
  std::vector<Vec3> positions_m(size);
  std::vector<char> open(size, 0);
  constexpr std::size_t block = 64;
  pool_->for_each((size + block - 1) / block, [&](std::size_t number, unsigned) {
    for (std::size_t point = number * block; point < std::min(size, (number + 1) * block); ++point) {
      positions_m[point] = order.position_m(point);
      open[point] = obstruction.obstructed(positions_m[point]) ? 0 : 1;
      for (RadioMap& map : maps) map.points[point] = {positions_m[point], is_grid && open[point] == 0, {}, {}};
    }
  });
  static_assert(detail::GridGroups::most_points == Crowd::most_points);
  const bool shares_views = plan_.joined > 0 && settings_.share_map_work && !transmitters.halves.empty();
  const auto is_free = [&](std::size_t from, std::size_t to) {
    return shares_views && !index_.occluded(segment_between(positions_m[from], positions_m[to]), {}, nullptr);
  };
  const std::vector<std::vector<std::size_t>> groups = is_grid ? detail::map_groups(order.places.grid(), open, is_free)
                                                               : detail::list_groups(positions_m, open, is_free);
  detail::MapProgress told(progress, size, is_grid ? static_cast<std::size_t>(std::ranges::count(open, 1)) : size);
  std::optional<MapShare> share;
  if (shares_views) share.emplace(*this, transmitters);
  std::vector<WorkCounters> spent(groups.size());
  std::vector<ReceiverRoom> rooms = receiver_rooms();
  pool_->for_each(groups.size(), [&](std::size_t number, unsigned worker) {
    const std::vector<std::size_t>& group = groups[number];
    std::vector<Vec3> points_m;
    for (const std::size_t point : group) points_m.push_back(positions_m[point]);
    typename MapShare::Joined joined;
    if (share && group.size() > 1) joined = share->join(*this, points_m, worker, spent[number]);
    for (std::size_t at = 0; at < group.size(); ++at) {
      const std::size_t point = group[at];
      const Solved solved = solve_alone(
          order.receiver(point), point, transmitters,
          {rooms.empty() ? nullptr : &rooms[worker], joined.empty() ? std::span<const SequenceList>{} : joined[at]});
      for (const LinkResult& link : solved.links)
        maps[link.transmitter].points[point] = detail::map_point(link, points_m[at]);
      spent[number] += solved.spent.work;
    }
    told.add(group.size());
  });
  if (work == nullptr) return maps;
  *work += transmitters.work;
  for (const WorkCounters& one : spent) *work += one;
  return maps;
}

}  // namespace dcem
