/// What lies in a cone: nothing that does is left out, little that does not is found, and every level of instructions
/// finds the same.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/core/random.hpp"
#include "dcem/paths/halves/edge_clusters.hpp"

namespace test_cone_walk {

using namespace dcem;

namespace {

struct Numbers {
  RandomStream random;
  double between(double low, double high) { return low + (high - low) * random.uniform(); }
  Vec3 place() { return {between(-80, 80), between(-80, 80), between(0, 30)}; }
};

Wedge edge_from(const Vec3& start_m, const Vec3& end_m) {
  Wedge edge;
  edge.start_m = start_m;
  edge.end_m = end_m;
  const Vec3 along = glm::normalize(end_m - start_m);
  edge.tangent = glm::normalize(glm::cross(along, Vec3(0.3, 0.5, 0.8)));
  edge.normal = glm::cross(along, edge.tangent);
  return edge;
}

/// Edges, their parts as an end sees them, and boxes.
struct Town {
  Numbers numbers;
  Vec3 end_m;
  std::vector<Wedge> edges;
  std::vector<EdgePart> parts;
  std::vector<Aabb<double>> boxes;
  EdgeClusters edge_clusters;
  ConeClusters box_clusters;

  explicit Town(std::uint64_t seed, double most = 900.0) : numbers{RandomStream(seed)}, end_m(numbers.place()) {
    const std::size_t count = 1 + static_cast<std::size_t>(numbers.between(0, most));
    for (std::uint32_t number = 0; number < count; ++number) {
      const Vec3 start_m = numbers.place();
      const double size_m = std::pow(10.0, numbers.between(-1.0, 1.6));
      edges.push_back(edge_from(start_m, start_m + size_m * glm::normalize(numbers.place())));
      parts.push_back(whole_edge(number, edges.back(), end_m));
      if (number % 3 == 0) parts.back().to *= 0.5F;
      Aabb<double> box;
      box.extend(start_m);
      box.extend(edges.back().end_m);
      boxes.push_back(box);
    }
    edge_clusters.build(parts, Vec3(0.0), [&](const EdgePart& part) -> const Wedge& { return edges[part.edge]; });
    box_clusters.build_for_items(boxes.size(), [&](std::uint32_t item) { return boxes[item]; });
  }

  /// Behind a window of so many corners, as an image sees it.
  std::vector<HalfSpace> cone(const Vec3& apex_m, int corners = 4) {
    const Vec3 window_m = apex_m + numbers.between(4.0, 25.0) * glm::normalize(numbers.place() - apex_m),
               aside = 8.0 * glm::normalize(glm::cross(window_m - apex_m, Vec3(0, 0.2, 1)));
    const Vec3 up(0.0, 0.0, numbers.between(1.0, 12.0));
    std::vector<Vec3> corners_m;
    for (int corner = 0; corner < corners; ++corner) {
      const double angle_rad = (2 * corner - 3) * pi / corners;
      corners_m.push_back(window_m + std::sqrt(2.0) * (std::sin(angle_rad) * aside - std::cos(angle_rad) * up));
    }
    std::vector<HalfSpace> planes;
    add_cone(Vec3(0.0), apex_m, {.point_m = window_m, .normal = glm::normalize(window_m - apex_m)}, corners_m, planes);
    return planes;
  }
};

/// By how much a point is inside of a cone.
double depth_m(std::span<const HalfSpace> cone, const Vec3& point_m) {
  double least_m = 1e30;
  for (const HalfSpace& plane : cone) {
    least_m = std::min(least_m, glm::dot(Vec3(plane.x, plane.y, plane.z), point_m) - static_cast<double>(plane.offset));
  }
  return least_m;
}

/// Where on an edge's line a way from the end to an apex is shortest.
double shortest_over_m(const Wedge& edge, const Vec3& end_m, const Vec3& apex_m) {
  const Vec3 along = edge_direction(edge);
  const double own_m = glm::dot(end_m - edge.start_m, along), far_m = glm::dot(apex_m - edge.start_m, along);
  const double own_off_m = glm::distance(end_m, edge.start_m + own_m * along),
               far_off_m = glm::distance(apex_m, edge.start_m + far_m * along);
  return own_m + (far_m - own_m) * own_off_m / (own_off_m + far_off_m);
}

std::vector<std::uint32_t> parts_in(const Town& town, std::span<const HalfSpace> cone, const Vec3& apex_m,
                                    float moved_m, bool end_moves) {
  std::vector<std::uint32_t> found;
  const auto note = [&](std::uint32_t part) { found.push_back(part); };
  if (end_moves) {
    town.edge_clusters.for_each_in<true>(cone, apex_m, moved_m, note);
  } else {
    town.edge_clusters.for_each_in(cone, apex_m, moved_m, note);
  }
  return found;
}

std::vector<std::uint32_t> boxes_in(const Town& town, std::span<const HalfSpace> cone) {
  std::vector<std::uint32_t> found;
  town.box_clusters.for_each_item_in(cone, [&](std::uint32_t item) { found.push_back(item); });
  return found;
}

/// The places of corners of boxes among all of them.
std::vector<std::uint32_t> corners_in(const Town& town, std::span<const HalfSpace> cone) {
  std::array<std::vector<float>, 3> row;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float>& places = row[static_cast<std::size_t>(axis)];
    for (const Aabb<double>& box : town.boxes) places.push_back(static_cast<float>(box.min[axis]));
    places.resize(places.size() + simd_lanes - 1, 0.0F);
  }
  std::vector<std::uint32_t> found;
  const auto note = [&](std::size_t first, std::uint32_t lanes) {
    for (std::uint32_t lane = 0; lane < simd_lanes; ++lane) {
      if ((lanes >> lane & 1U) != 0) found.push_back(static_cast<std::uint32_t>(first) + lane);
    }
  };
  detail::cone_kernels().points({{row[0].data(), row[1].data(), row[2].data()}, town.boxes.size()}, cone,
                                told_to(note));
  return found;
}

/// The same with each corner as an image that sees the apex through its mirror, but for every third one.
std::vector<std::uint32_t> images_in(const Town& town, std::span<const HalfSpace> cone, const Vec3& apex_m) {
  ConeClusters clusters;
  clusters.build(town.boxes.size(), [&](std::uint32_t item) {
    Aabb<double> box;
    box.extend(town.boxes[item].min);
    return box;
  });
  std::vector<EightImages> eights(clusters.items().size() / simd_lanes);
  for (std::size_t at = 0; at < clusters.items().size(); ++at) {
    const std::uint32_t item = clusters.items()[at];
    if (item == ConeClusters::nothing) continue;
    EightImages& eight = eights[at / simd_lanes];
    const std::size_t lane = at % simd_lanes;
    for (int axis = 0; axis < 3; ++axis) {
      eight.place[static_cast<std::size_t>(axis)][lane] = static_cast<float>(town.boxes[item].min[axis]);
    }
    for (auto& plane : eight.planes) plane[3][lane] = -1.0F;
    if (item % 3 == 0) eight.planes[item % eight.planes.size()][3][lane] = 1.0F;
  }
  std::vector<std::uint32_t> found;
  const auto note = [&](std::size_t first, std::uint32_t lanes) {
    clusters.for_each_of(first, lanes, [&](std::uint32_t item) { found.push_back(item); });
  };
  detail::cone_kernels().images(clusters.tree(), eights, cone, edge_target(apex_m, 0.0F), told_to(note));
  return found;
}

bool holds(const std::vector<std::uint32_t>& found, std::uint32_t number) {
  return std::find(found.begin(), found.end(), number) != found.end();
}

}  // namespace

TEST_CASE("no part whose point that diffracts is in the cone is left out, and few are found whose point is not") {
  std::size_t inside = 0, found_outside = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    CAPTURE(seed);
    Town town(seed);
    const Vec3 apex_m = town.numbers.place();
    const std::vector<HalfSpace> cone = town.cone(apex_m);
    const std::vector<std::uint32_t> found = parts_in(town, cone, apex_m, 0.0F, false);
    for (std::uint32_t number = 0; number < town.parts.size(); ++number) {
      const Wedge& edge = town.edges[number];
      const EdgePart& part = town.parts[number];
      const double at_m = shortest_over_m(edge, town.end_m, apex_m);
      const double beside_m = std::min(at_m - static_cast<double>(part.from), static_cast<double>(part.to) - at_m);
      const double in_m = std::min(beside_m, depth_m(cone, edge.start_m + at_m * edge_direction(edge)));
      if (in_m >= 0.0) {
        ++inside;
        CHECK(holds(found, number));
      }
      // The room for single precision is below 6 mm in a town of 200 m.
      if (in_m < -0.01) CHECK_FALSE(holds(found, number));
      found_outside += in_m < 0.0 && holds(found, number) ? 1U : 0U;
    }
  }
  CHECK(inside > 300);
  CHECK(found_outside < inside / 20);
}

TEST_CASE("where the apex or the end may be elsewhere, what any such place finds is found") {
  for (const bool end_moves : {false, true}) {
    std::size_t inside = 0;
    for (std::uint64_t seed = 101; seed <= 130; ++seed) {
      CAPTURE(seed);
      Town town(seed);
      const double moved_m = town.numbers.between(0.1, 6.0);
      const Vec3 apex_m = town.numbers.place();
      const std::vector<HalfSpace> cone = town.cone(apex_m);
      const std::vector<std::uint32_t> found = parts_in(town, cone, apex_m, static_cast<float>(moved_m), end_moves);
      for (int draw = 0; draw < 10; ++draw) {
        const Vec3 step_m = town.numbers.between(0.0, moved_m) * glm::normalize(town.numbers.place());
        const Vec3 from_m = town.end_m + (end_moves ? step_m : Vec3(0.0)),
                   to_m = apex_m + (end_moves ? Vec3(0.0) : step_m);
        for (std::uint32_t number = 0; number < town.parts.size(); ++number) {
          const Wedge& edge = town.edges[number];
          const double at_m = shortest_over_m(edge, from_m, to_m);
          if (at_m < static_cast<double>(town.parts[number].from) ||
              at_m > static_cast<double>(town.parts[number].to)) {
            continue;
          }
          if (depth_m(cone, edge.start_m + at_m * edge_direction(edge)) < 0.0) continue;
          ++inside;
          CHECK(holds(found, number));
        }
      }
    }
    CHECK(inside > 1000);
  }
}

TEST_CASE("no box with a corner in the cone is left out, and no corner; beyond a window of many corners neither") {
  std::size_t inside = 0;
  for (std::uint64_t seed = 201; seed <= 260; ++seed) {
    CAPTURE(seed);
    Town town(seed);
    const Vec3 apex_m = town.numbers.place();
    const std::vector<HalfSpace> cone = town.cone(apex_m, seed <= 230 ? 4 : 3 + static_cast<int>(seed % 30));
    const std::vector<std::uint32_t> corners = corners_in(town, cone), images = images_in(town, cone, apex_m);
    CHECK(std::ranges::all_of(corners, [&](std::uint32_t item) { return item < town.boxes.size(); }));
    const std::vector<std::uint32_t> found = boxes_in(town, cone);
    for (std::uint32_t item = 0; item < town.boxes.size(); ++item) {
      const Aabb<double>& box = town.boxes[item];
      const double in_m = depth_m(cone, box.min);
      // Single precision has room for a fraction of a millimetre in a town of 200 m.
      if (in_m >= 0.0 || in_m < -1e-3) {
        CHECK(holds(corners, item) == (in_m >= 0.0));
        CHECK(holds(images, item) == (in_m >= 0.0 && item % 3 != 0));
      }
      if (depth_m(cone, box.min) < 0.0 && depth_m(cone, box.max) < 0.0) continue;
      ++inside;
      CHECK(holds(found, item));
    }
    CHECK(found.size() < town.boxes.size());
  }
  CHECK(inside > 200);
}

TEST_CASE(
    "nothing is left out of a cone without sides, however many there are, and nothing is found where nothing is") {
  for (const double most : {6.0, 60.0, 600.0, 9000.0}) {
    const Town town(401, most);
    CAPTURE(town.boxes.size());
    CHECK(boxes_in(town, {}).size() == town.boxes.size());
    CHECK(corners_in(town, {}).size() == town.boxes.size());
  }
  const EdgeClusters none;
  none.for_each_in({}, Vec3(0.0), 0.0F, [](std::uint32_t) { FAIL_CHECK("there is nothing"); });
}

#if defined(DCEM_ENGINE)

TEST_CASE("every level of instructions that the processor has finds the same in the same order") {
  const InstructionSet before = instruction_set();
  for (std::uint64_t seed = 301; seed <= 340; ++seed) {
    CAPTURE(seed);
    Town town(seed, seed < 330 ? 900.0 : 9000.0);
    const Vec3 apex_m = town.numbers.place();
    const std::vector<HalfSpace> cone = town.cone(apex_m, 3 + static_cast<int>(seed % 30));
    const auto moved_m = static_cast<float>(seed % 2) * 2.5F;
    const auto find_all = [&] {
      return std::array{parts_in(town, cone, apex_m, moved_m, false), parts_in(town, cone, apex_m, moved_m, true),
                        boxes_in(town, cone), corners_in(town, cone), images_in(town, cone, apex_m)};
    };
    select_instruction_set(InstructionSet::baseline);
    const auto expected = find_all();
    for (const InstructionSet set : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (!is_supported(set)) continue;
      select_instruction_set(set);
      CHECK(find_all() == expected);
    }
  }
  select_instruction_set(before);
}

#endif

}  // namespace test_cone_walk
