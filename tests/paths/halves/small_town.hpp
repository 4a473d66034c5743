#pragma once
/// Random towns, and their paths by trying every sequence: what the search from halves is held against.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "dcem/paths/halves/link_halves.hpp"
#include "dcem/paths/path_finder.hpp"
#include "tests/paths/small_scenes.hpp"

namespace dcem::test {

/// A ground, houses, sheets, and two cars that are bodies of their own.
inline Scene small_town(Draw& draw) {
  TriangleMesh mesh;
  if (draw.below(4) != 0) add_sheet(mesh, Vec3(0.0), Vec3(30, 0, 0), Vec3(0, 30, 0), "opaque");
  const std::size_t houses = 1 + draw.below(4), sheets = draw.below(4);
  for (std::size_t house = 0; house < houses; ++house) {
    const Vec3 low_m(draw.between(-20, 15), draw.between(-20, 15), draw.below(2) == 0 ? 0.0 : 0.01);
    add_box_faces(mesh, low_m, low_m + draw.inside(Vec3(2, 2, 2), Vec3(10, 10, 12)), "metal");
  }
  for (std::size_t sheet = 0; sheet < sheets; ++sheet) {
    const double turn = draw.between(-pi, pi);
    const Vec3 along(std::cos(turn), std::sin(turn), 0);
    add_sheet(mesh, draw.inside(Vec3(-20, -20, 2), Vec3(20, 20, 4)), draw.between(1, 6) * along, Vec3(0, 0, 2),
              draw.below(2) == 0 ? "glass" : "wall");
  }
  Scene scene = scene_of(mesh);
  for (const char* name : {"one", "two"}) {
    TriangleMesh car;
    add_box_faces(car, Vec3(-2, -0.9, 0), Vec3(2, 0.9, 1.5), "metal");
    const double turn_rad = draw.between(-pi, pi);
    scene.add_object(name, car, LinearMotion{{draw.inside(Vec3(-20, -20, 0.02), Vec3(20, 20, 0.05)), turn_rad, 0, 0}});
  }
  return scene;
}

/// All edges that an end reaches.
inline EdgeReach reach_of(TracedScene<>& traced, const LinkEnd& end, const PathSearchSettings& settings) {
  EdgeReach reach;
  SearchCounters counters;
  find_reach(traced.tracer, settings, end, {"end", 0}, 0, reach, counters);
  return reach;
}

/// How two ends are searched.
struct Asked {
  int transmissions = 0;
  int reflections = 2, diffractions = 1, interactions = 2;
  bool free_edges = false;
};

inline std::vector<Path> all_sequences(TracedScene<>& traced, const LinkEnd& from, const LinkEnd& to,
                                       const Asked& asked) {
  PathSearchSettings settings;
  settings.max_reflections = asked.reflections;
  settings.max_diffractions = asked.diffractions;
  settings.max_interactions = asked.interactions;
  settings.max_transmissions = asked.transmissions;
  settings.edges.free_edges = asked.free_edges;
  SearchCounters counters;
  EdgeReach reach = reach_of(traced, from, settings);
  const std::vector<std::optional<LinkEnd>> ends{from};
  const std::vector<ReachedEdges> reached{reach.edges()};
  return find_paths(traced.tracer, settings, to, {"rx", 0}, ends, counters, nullptr, reached).front().paths;
}

/// What an exact search is asked for.
inline PathSearchSettings search_settings_of(const Asked& asked) {
  PathSearchSettings settings;
  settings.max_reflections = asked.reflections;
  settings.max_diffractions = asked.diffractions;
  settings.max_interactions = asked.interactions;
  settings.max_transmissions = asked.transmissions;
  settings.edges.free_edges = asked.free_edges;
  return settings;
}

/// The same for halves that are joined.
inline PathSearchSettings joined_settings_of(const Asked& asked) {
  PathSearchSettings settings = search_settings_of(asked);
  settings.exhaustive = false;
  settings.joined = most_joined_interactions;
  settings.rays = 0;
  return settings;
}

/// What the transmitter has listed beforehand.
enum class Listed { nothing, scenery, all };

/// The same by joining halves.
inline std::vector<Path> joined(TracedScene<>& traced, const LinkEnd& from, const LinkEnd& to, const Asked& asked,
                                int pixels = 256, Listed listed = Listed::all) {
  const PathSearchSettings settings = joined_settings_of(asked);
  const FacetOutlines outlines(traced.scene);
  std::vector<KeptHalf> transmitters(1, KeptHalf(pixels));
  const LaneScene lanes(traced.scene, outlines);
  transmitters[0].update(traced.scene, outlines, from, half_settings(settings),
                         {listed == Listed::nothing ? nullptr : &lanes, true, listed == Listed::all, 1000});
  ReceiverRoom room{PathHalf(pixels), {}};
  SearchCounters counters;
  const std::vector<std::optional<LinkEnd>> ends{from};
  look_from(traced.scene, settings, outlines, lanes, to, room);
  const std::vector<SequenceList> proposed =
      join_halves(traced.scene, settings, {outlines, lanes, HalfRefs(transmitters), room.half, room.lists}, ends);
  const std::vector<ReachedEdges> reached(1);
  return find_paths(traced.tracer, settings, to, {"rx", 0}, ends, counters, nullptr, reached, proposed).front().paths;
}

/// The same sequences, and the same bits of every point.
inline bool same_paths(const std::vector<Path>& one, const std::vector<Path>& other) {
  if (one.size() != other.size()) return false;
  for (std::size_t path = 0; path < one.size(); ++path) {
    if (!same_sequence(one[path], other[path]) || one[path].length_m != other[path].length_m) return false;
    for (std::size_t point = 0; point < one[path].interactions.size(); ++point) {
      if (one[path].interactions[point].point_m != other[path].interactions[point].point_m) return false;
    }
  }
  return true;
}

/// Checks both searches against each other; returns how many paths there are.
inline std::size_t check_joined(TracedScene<>& traced, const LinkEnd& from, const LinkEnd& to, const Asked& asked,
                                int pixels = 256) {
  const std::vector<Path> expected = all_sequences(traced, from, to, asked);
  for (const Listed listed : {Listed::nothing, Listed::scenery, Listed::all}) {
    CHECK(same_paths(joined(traced, from, to, asked, pixels, listed), expected));
  }
  return expected.size();
}

inline LinkEnd somewhere(TracedScene<>& traced, Draw& draw) {
  return traced.end(draw.inside(Vec3(-20, -20, 0.3), Vec3(20, 20, 14)));
}

/// An end 300 or 3000 km from the town, above the ground.
inline LinkEnd far_away(TracedScene<>& traced, Draw& draw) {
  const double turn = draw.between(-pi, pi), away_m = draw.below(2) == 0 ? 3e5 : 3e6;
  return traced.end(away_m * Vec3(std::cos(turn), std::sin(turn), draw.between(0.2, 1.0)));
}

/// Sheets and houses on a grid of whole metres: ends on the same grid lie in planes of facets and on lines of edges.
inline Scene town_on_grid(Draw& draw) {
  TriangleMesh mesh;
  const auto whole = [&](int low, int high) {
    return static_cast<double>(low + static_cast<int>(draw.below(static_cast<std::uint64_t>(high - low + 1))));
  };
  for (int sheet = 0; sheet < 4; ++sheet) {
    const Vec3 centre(whole(-6, 6), whole(-6, 6), whole(2, 4)), up(0, 0, 2);
    add_sheet(mesh, centre, draw.below(2) == 0 ? Vec3(whole(1, 4), 0, 0) : Vec3(0, whole(1, 4), 0), up,
              draw.below(2) == 0 ? "metal" : "glass");
  }
  for (int house = 0; house < 2; ++house) {
    const Vec3 low_m(whole(-8, 5), whole(-8, 5), 0);
    add_box_faces(mesh, low_m, low_m + Vec3(whole(1, 4), whole(1, 4), whole(2, 6)), "metal");
  }
  return scene_of(mesh);
}

inline Vec3 point_on_grid(Draw& draw) {
  const auto whole = [&](int low, int high) {
    return static_cast<double>(low + static_cast<int>(draw.below(static_cast<std::uint64_t>(high - low + 1))));
  };
  return {whole(-8, 8), whole(-8, 8), whole(1, 6)};
}

/// Checks a link on the grid for every seed, free edges included and up to one transmission, which is drawn; returns
/// how many paths there are.
inline std::size_t check_grid_links(std::uint64_t first_seed, std::uint64_t end_seed, Asked asked) {
  std::size_t found = 0;
  asked.free_edges = true;
  for (std::uint64_t seed = first_seed; seed < end_seed; ++seed) {
    Draw draw(seed);
    TracedScene<> traced(town_on_grid(draw));
    asked.transmissions = static_cast<int>(draw.below(2));
    CAPTURE(seed);
    const LinkEnd from = traced.end(point_on_grid(draw)), to = traced.end(point_on_grid(draw));
    if (from.position_m == to.position_m) continue;
    found += check_joined(traced, from, to, asked);
  }
  return found;
}

}  // namespace dcem::test
