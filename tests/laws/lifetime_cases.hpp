#pragma once
/// Links of random towns with their lifetimes, and motions within them.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "dcem/paths/lifetime/lifetime_finder.hpp"
#include "dcem/paths/path_id.hpp"
#include "tests/paths/halves/small_town.hpp"

namespace dcem::test {

/// The lifetime of a link that has these paths.
inline double lifetime_m(TracedScene<>& traced, const LinkEnd& from, const LinkEnd& to, const Asked& asked,
                         const std::vector<Path>& paths, double limit_m = 1.0) {
  const PathSearchSettings search = search_settings_of(asked);
  const FacetOutlines outlines(traced.scene);
  const FacetRims rims(traced.scene);
  const std::vector<std::optional<LinkEnd>> ends{from};
  LifetimeFinder<WideIndex> finder(traced.tracer, outlines, rims,
                                   {limit_m, joined_orders(search), search.edges, search.max_transmissions, true},
                                   half_settings(search), ends);
  LifetimeFinder<WideIndex>::Receiver receiver(finder, to);
  std::vector<Sequence> open;
  for (const Path& path : paths) open.push_back(sequence_of(path));
  return receiver.valid_until_m(0, open);
}

/// Where both ends and all bodies are.
struct Configuration {
  Frame frame;
  Vec3 from_m, to_m;
};

/// What moves, and along what.
enum class MotionKind { all, one_end, together, along_axes, turns, count };

/// The farthest that a corner of a body moves between two poses.
inline double farthest_m(const Body& body, const Pose& one, const Pose& other) {
  double most_m = 0.0;
  for (const Vec3& vertex_m : body.mesh.vertices_m) {
    most_m = std::max(most_m, glm::distance(one.position_m + rotation_matrix(one) * vertex_m,
                                            other.position_m + rotation_matrix(other) * vertex_m));
  }
  return most_m;
}

/// A pose at which the corner that has moved farthest has moved by `moved_m`.
inline Pose moved_pose(Draw& draw, const Body& body, const Pose& pose, double moved_m, bool turns) {
  const Vec3 way = draw.direction() * (turns ? 0.1 : draw.between(0.0, 1.0));
  const Vec3 turn = draw.direction() * (turns ? 1.0 : draw.between(0.0, 0.5));
  const auto at = [&](double share) {
    Pose next = pose;
    next.position_m += share * way;
    next.yaw_rad += share * turn.z;
    next.pitch_rad += share * turn.y;
    next.roll_rad += share * turn.x;
    return next;
  };
  double low = 0.0, high = 1.0;
  while (farthest_m(body, pose, at(high)) < moved_m && high < 1e3) high *= 2.0;
  for (int step = 0; step < 50; ++step) {
    const double middle = 0.5 * (low + high);
    (farthest_m(body, pose, at(middle)) <= moved_m ? low : high) = middle;
  }
  return at(low);
}

/// Nothing moves by more than `moved_m`, and what moves does so by just that.
inline Configuration moved(Draw& draw, const Scene& scene, const Configuration& now, double moved_m, MotionKind kind) {
  Configuration next = now;
  const Vec3 axes[] = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  const auto way = [&] {
    if (kind != MotionKind::along_axes) return draw.direction();
    return (draw.below(2) == 0 ? 1.0 : -1.0) * axes[draw.below(3)];
  };
  const Vec3 first = way(), second = kind == MotionKind::together ? first : way();
  const bool only_one = kind == MotionKind::one_end;
  const std::size_t which = draw.below(2);
  if (!only_one || which == 0) next.from_m += moved_m * first;
  if (!only_one || which == 1) next.to_m += moved_m * second;
  for (std::size_t body = 1; body < scene.bodies().size(); ++body) {
    if (only_one) continue;
    Pose& pose = next.frame.bodies[body].placement.pose;
    pose = moved_pose(draw, scene.bodies()[body], pose, moved_m, kind == MotionKind::turns);
  }
  return next;
}

/// All paths of a configuration by trying every sequence.
inline std::vector<Path> paths_at(TracedScene<>& traced, const Configuration& at, const Asked& asked) {
  traced.apply(at.frame);
  return all_sequences(traced, traced.end(at.from_m), traced.end(at.to_m), asked);
}

/// Whether two links have the same paths, whatever their order.
inline bool same_set(const std::vector<Path>& one, const std::vector<Path>& other) {
  return one.size() == other.size() && std::ranges::all_of(one, [&](const Path& path) {
           return std::ranges::any_of(other, [&](const Path& twin) { return same_sequence(path, twin); });
         });
}

/// Words for what differs.
inline std::string difference(const Scene& scene, const std::vector<Path>& before, const std::vector<Path>& after) {
  std::string words;
  const auto add = [&](const char* word, const std::vector<Path>& own, const std::vector<Path>& others) {
    for (const Path& path : own) {
      if (std::ranges::none_of(others, [&](const Path& twin) { return same_sequence(path, twin); }))
        words += word + path_id(scene, path);
    }
  };
  add(" lost ", before, after);
  add(" new ", after, before);
  return words;
}

}  // namespace dcem::test
