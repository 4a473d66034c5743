#pragma once
/// Drives for the tests of how a wide tree is kept, and what those tests count for themselves.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dcem/accel/wide_bvh.hpp"
#include "tests/accel/wide/wide_scenes.hpp"

namespace dcem_test {

/// A ground, which is no unit, and objects that drive about on it, may bend, go and come back.
class WideTraffic {
 public:
  struct Kind {
    std::uint32_t objects = 60;
    double half_side_m = 12.0;
    bool deforms = false, vanishes = false, has_ground = true;
  };

  WideTraffic(const Kind& kind, std::uint64_t seed) : kind_(kind), random_(seed) {
    // Without ground object 0 is an object as the others.
    append(bent_ground(kind.has_ground ? 16 : 2, 1e-4, seed));
    for (std::uint32_t object = 1; object <= kind.objects; ++object) {
      const double size = between(random_, 0.2, 0.8);
      if (object % 7 == 0) {
        append(ball(Vec3(0), size, 5));  // several leaves
      } else {
        append(box_mesh(Vec3(-size, -0.5 * size, 0.01), Vec3(size, 0.5 * size, size)));
      }
    }
    object_first.pop_back();
    mesh.absent.assign(mesh.triangles.size(), false);
    at_rest_ = mesh.vertices;
    states_.resize(object_first.size());
    for (State& state : states_) {
      state.position = random_in_cube(random_, kind.half_side_m) * Vec3(1, 1, 0);
      state.speed = random_in_cube(random_, 0.025 * kind.half_side_m) * Vec3(1, 1, 0);
    }
    for (std::uint32_t object = 1; object < object_first.size(); ++object) place(object);
    boxes = mesh.boxes();
  }

  /// One frame: three quarters of the objects move, some vanish or return.
  void step() {
    moved.clear();
    for (std::uint32_t object = 1; object < object_first.size(); ++object) {
      State& state = states_[object];
      const double chance = random_.uniform();
      if (chance > 0.75) continue;
      if (kind_.vanishes && chance < 0.03) state.is_gone = !state.is_gone;
      state.position += state.speed;
      for (int axis = 0; axis < 2; ++axis) {
        if (std::abs(state.position[axis]) > kind_.half_side_m) {
          state.speed[axis] = -std::copysign(state.speed[axis], state.position[axis]);
        }
      }
      place(object);
    }
    boxes = mesh.boxes();
  }
  /// Puts every object where it pleases `position(object)`.
  template <typename Position>
  void place_all(Position&& position) {
    moved.clear();
    for (std::uint32_t object = 1; object < object_first.size(); ++object) {
      states_[object].position = position(object);
      place(object);
    }
    boxes = mesh.boxes();
  }
  /// All objects vanish, or return.
  void set_absent(bool absent) {
    moved.clear();
    for (std::uint32_t object = 1; object < object_first.size(); ++object) {
      states_[object].is_gone = absent;
      place(object);
    }
    boxes = mesh.boxes();
  }

  dcem::WideBvh built() const {
    dcem::WideBvh tree;
    dcem::WideBuildSettings settings;
    settings.object_subtree_limit = 200;  // the ground is larger
    tree.build_objects(mesh.view(), boxes, object_first, settings);
    return tree;
  }
  void refit(dcem::WideBvh& tree) const { tree.refit(moved, mesh.view(), boxes); }

  WideMesh mesh;
  std::vector<std::uint32_t> object_first{0}, moved;
  std::vector<Aabb<double>> boxes;

 private:
  struct State {
    Vec3 position{0.0}, speed{0.0};
    bool is_gone = false;
  };

  void append(const WideMesh& part) {
    mesh.append(part);
    object_first.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
    vertex_first_.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
  }
  void place(std::uint32_t object) {
    const State& state = states_[object];
    const bool bends = kind_.deforms && object % 3 == 0;
    for (std::uint32_t vertex = vertex_first_[object - 1]; vertex < vertex_first_[object]; ++vertex) {
      mesh.vertices[vertex] = state.position + at_rest_[vertex] + (bends ? random_in_cube(random_, 0.4) : Vec3(0.0));
    }
    const auto end = object + 1 < object_first.size() ? object_first[object + 1] : mesh.triangles.size();
    for (std::uint32_t triangle = object_first[object]; triangle < end; ++triangle) {
      mesh.absent[triangle] = state.is_gone;
      moved.push_back(triangle);
    }
  }

  Kind kind_;
  RandomStream random_;
  std::vector<std::uint32_t> vertex_first_;
  std::vector<Vec3> at_rest_;
  std::vector<State> states_;
};

inline bool same_hit(const std::optional<dcem::TriangleHit>& one, const std::optional<dcem::TriangleHit>& other) {
  if (one.has_value() != other.has_value()) return false;
  return !one || (std::bit_cast<std::uint64_t>(one->t) == std::bit_cast<std::uint64_t>(other->t) &&
                  one->triangle == other->triangle);
}

/// A tree keeps its promises, and gives the oracle's answers with the bits of a tree that was built now.
inline void check_answers(const dcem::WideBvh& tree, const WideTraffic& traffic, int rays, RandomStream& random) {
  REQUIRE(tree.validate(traffic.boxes) == "");
  const dcem::WideBvh fresh = traffic.built();
  for (int trial = 0; trial < rays; ++trial) {
    const Ray<double> ray = any_ray(random, traffic.mesh, fresh.bounds());
    INFO(text_of(ray));
    const auto line = hits_on_line(traffic.mesh, ray);
    const auto hit = tree.closest_hit(ray);
    REQUIRE(fault_of_closest(line, ray, hit) == "");
    REQUIRE(same_hit(hit, fresh.closest_hit(ray)));
    const int in_the_way = oracle_occluded(line, ray);
    if (in_the_way >= 0) REQUIRE(tree.occluded(ray) == (in_the_way == 1));
  }
}

/// The nodes in use, parents first.
inline std::vector<std::uint32_t> nodes_of(const dcem::WideArrays& arrays) {
  std::vector<std::uint32_t> nodes{0};
  for (std::size_t next = 0; next < nodes.size(); ++next) {
    for (const dcem::WideChild child : arrays.nodes[nodes[next]].child) {
      if (!child.is_none() && !child.is_leaf()) nodes.push_back(child.index());
    }
  }
  return nodes;
}

/// The deepest depth of a node, 1 for the root alone.
inline std::uint32_t depth_below(const dcem::WideArrays& arrays, std::uint32_t node = 0) {
  std::uint32_t below = 0;
  for (const dcem::WideChild child : arrays.nodes[node].child) {
    if (!child.is_none() && !child.is_leaf()) below = std::max(below, depth_below(arrays, child.index()));
  }
  return below + 1;
}

}  // namespace dcem_test
