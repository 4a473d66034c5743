#pragma once
/// Computes the numbers of a leaf of quads, several lanes at once.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "dcem/accel/wide/node.hpp"
#include "dcem/accel/wide/quad.hpp"
#include "dcem/accel/wide/update/double_lanes.hpp"
#include "dcem/accel/wide/update/quad_edges.hpp"
#include "dcem/core/simd.hpp"
#include "dcem/geometry/aabb.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem::detail {

/// The quads of a leaf, one in every lane.
struct LeafQuads {
  std::array<const Quad*, simd_lanes> in_lane;
  std::array<Quad, simd_lanes> halves;  ///< what is left of pairs that are there in part
};

inline namespace DCEM_ISA {

/// The numbers of a leaf, from the quads in it.
class LeafNumbers {
 public:
  /// Takes the corners of eight quads, none of them absent. What stands in lanes that do not count must be a quad of
  /// the leaf as well: `bounds_m` goes around all.
  LeafNumbers(const std::array<const Quad*, simd_lanes>& quads, std::span<const Vec3> vertices_m) {
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      begin_[0][lane] = quads[lane]->begin[0];
      begin_[1][lane] = quads[lane]->begin[1];
      is_pair_[lane] = quads[lane]->is_pair() ? 1 : 0;
    }
    begins_at_a_.fill(true);
    for (std::size_t lane = 0; lane < simd_lanes; ++lane) {
      if ((quads[lane]->begin[0] | quads[lane]->begin[1]) != 0) begins_at_a_[lane / double_part_lanes] = false;
    }
    for (std::size_t part = 0; part < parts; ++part) {
      for (std::size_t corner = 0; corner < 4; ++corner) {
        world_m_[part][corner].set([&](std::size_t lane) -> const Vec3& {
          return vertices_m[quads[part * double_part_lanes + lane]->corner[corner]];
        });
      }
    }
  }

  Aabb<double> bounds_m() const {
    VectorPart low = world_m_[0][0], high = low;
    for (const std::array<VectorPart, 4>& part : world_m_) {
      for (const VectorPart& corner : part) {
        low.x = low.x < corner.x ? low.x : corner.x;
        low.y = low.y < corner.y ? low.y : corner.y;
        low.z = low.z < corner.z ? low.z : corner.z;
        high.x = high.x > corner.x ? high.x : corner.x;
        high.y = high.y > corner.y ? high.y : corner.y;
        high.z = high.z > corner.z ? high.z : corner.z;
      }
    }
    const auto lower = [](const auto& one, const auto& other) { return one < other ? one : other; };
    return {{fold_lanes(low.x, lower), fold_lanes(low.y, lower), fold_lanes(low.z, lower)},
            {fold_lanes(high.x, larger), fold_lanes(high.y, larger), fold_lanes(high.z, larger)}};
  }

  /// Writes what there is of each lane; the normals are kept. Corners count from `origin_m` + `centre_m`, which are
  /// subtracted one after the other.
  void write(const Vec3& origin_m, const Vec3& centre_m, QuadLeaf& leaf) {
    bend_m_ = diameter_m_ = DoublePart{};
    for (std::size_t part = 0; part < parts; ++part) write_part(part, origin_m, centre_m, leaf);
    leaf.bend_m = static_cast<float>(fold_lanes(bend_m_, larger));
    leaf.reach_m = static_cast<float>(fold_lanes(diameter_m_, larger) * QuadLeaf::edge_error_factor);
  }

  void write_normal(std::size_t side, std::size_t lane, Vec3& to) const {
    to.x = normal_[side][0][lane];
    to.y = normal_[side][1][lane];
    to.z = normal_[side][2][lane];
  }
  /// |n₁ − n₀|² of a pair.
  double difference_squared(std::size_t lane) const { return difference_squared_[lane]; }

 private:
  static constexpr auto larger = [](const auto& one, const auto& other) { return one > other ? one : other; };

  static constexpr std::size_t parts = simd_lanes / double_part_lanes;
  using Row = std::array<double, simd_lanes>;
  using Codes = std::array<std::int64_t, simd_lanes>;

  [[gnu::always_inline]] static LongPart codes(const Codes& of, std::size_t part) {
    LongPart result;
    std::memcpy(&result, of.data() + part * double_part_lanes, sizeof result);
    return result;
  }

  [[gnu::always_inline]] void write_part(std::size_t part, const Vec3& origin_m, const Vec3& centre_m, QuadLeaf& leaf) {
    const std::size_t first = part * double_part_lanes;
    const LongPart is_pair = codes(is_pair_, part) != 0;
    std::array<VectorPart, 4> corner;
    place_corners(world_m_[part], origin_m, centre_m, is_pair, corner);
    for (std::size_t index = 0; index < 4; ++index) store(corner[index], leaf.corner_m[index], first);
    QuadEdges edges;
    edges.set(world_m_[part]);
    VectorPart normal, other_normal;
    set_normals(part, edges, normal, other_normal);
    store(normal, leaf.normal, first);
    DoublePart bend, diameter, sound;
    normal.dot(edges.ad, bend);
    edges.set_diameter(diameter);
    edges.set_soundness(normal, sound);
    // Without a plane, or where the vertices have moved until the pair is not convex, nothing is certain, but every
    // ray near it is asked.
    bend = sound > 0.0 ? absolute(bend) * 1.0001 : diameter;
    bend = is_pair ? bend : DoublePart{};
    bend_m_ = bend > bend_m_ ? bend : bend_m_;
    diameter_m_ = diameter > diameter_m_ ? diameter : diameter_m_;
  }

  [[gnu::always_inline]] static void store(const VectorPart& vector, std::array<std::array<float, simd_lanes>, 3>& rows,
                                           std::size_t first) {
    store_narrow(vector.x, rows[0].data() + first);
    store_narrow(vector.y, rows[1].data() + first);
    store_narrow(vector.z, rows[2].data() + first);
  }

  /// A triangle becomes a quadrilateral with its fourth corner in the middle of an edge: it has no edge without length.
  [[gnu::always_inline]] static void place_corners(const std::array<VectorPart, 4>& world, const Vec3& origin_m,
                                                   const Vec3& centre_m, const LongPart& is_pair,
                                                   std::array<VectorPart, 4>& corner) {
    for (std::size_t index = 0; index < 4; ++index) {
      corner[index].x = (world[index].x - origin_m.x) - centre_m.x;
      corner[index].y = (world[index].y - origin_m.y) - centre_m.y;
      corner[index].z = (world[index].z - origin_m.z) - centre_m.z;
    }
    VectorPart middle;
    middle.x = 0.5 * (corner[0].x + corner[2].x);
    middle.y = 0.5 * (corner[0].y + corner[2].y);
    middle.z = 0.5 * (corner[0].z + corner[2].z);
    corner[3].set_where(is_pair, corner[3], middle);
  }

  [[gnu::always_inline]] void set_normals(std::size_t part, const QuadEdges& edges, VectorPart& normal,
                                          VectorPart& other_normal) {
    const std::array<VectorPart, 4>& world = world_m_[part];
    const std::size_t first = part * double_part_lanes;
    if (begins_at_a_[part]) {
      normal = edges.at_b;
      other_normal = edges.at_d;
    } else {
      set_product(codes(begin_[0], part), {world[0], world[1], world[2]}, edges.at_b, normal);
      set_product(codes(begin_[1], part), {world[0], world[2], world[3]}, edges.at_d, other_normal);
    }
    make_object(normal);
    make_object(other_normal);
    normal.store(&normal_[0][0][first], &normal_[0][1][first], &normal_[0][2][first]);
    other_normal.store(&normal_[1][0][first], &normal_[1][1][first], &normal_[1][2][first]);
    DoublePart difference;
    other_normal.set_difference(other_normal, normal);
    other_normal.dot(other_normal, difference);
    std::memcpy(&difference_squared_[first], &difference, sizeof difference);
  }

  /// What points along the normal of a triangle with these corners. `begin`: which of them is its first. (Which of the
  /// others is the second changes the sign of the product and nothing else.) `towards`: where the quad's own order of
  /// corners points, and the product itself where the triangle begins with the first.
  [[gnu::always_inline]] static void set_product(const LongPart& begin, const std::array<VectorPart, 3>& corner,
                                                 const VectorPart& towards, VectorPart& result) {
    VectorPart first, next, last;
    const LongPart is_one = begin == 1, is_two = begin == 2;
    first.set_where(is_one, corner[1], corner[0]);
    first.set_where(is_two, corner[2], first);
    next.set_where(is_one, corner[2], corner[1]);
    next.set_where(is_two, corner[0], next);
    last.set_where(is_one, corner[0], corner[2]);
    last.set_where(is_two, corner[1], last);
    next.set_difference(next, first);
    last.set_difference(last, first);
    result.set_cross(next, last);
    DoublePart along;
    result.dot(towards, along);
    result.scale(along < 0.0 ? DoublePart{} - 1.0 : DoublePart{} + 1.0);
  }

  [[gnu::always_inline]] static void make_object(VectorPart& vector) {
    DoublePart squared, scale;
    vector.dot(vector, squared);
    set_reciprocal_root(scale, squared, 4);
    vector.scale(squared > least_squared_length ? scale : DoublePart{});
  }

  std::array<std::array<VectorPart, 4>, parts> world_m_;
  alignas(64) std::array<Codes, 2> begin_;
  alignas(64) Codes is_pair_;
  std::array<bool, parts> begins_at_a_;  ///< both triangles, in all lanes
  std::array<std::array<Row, 3>, 2> normal_;
  Row difference_squared_;
  DoublePart bend_m_, diameter_m_;  ///< the largest of the lanes so far
};

}  // namespace DCEM_ISA

}  // namespace dcem::detail
