/// A box of mirrors: its images stand on a lattice, so its paths can be counted without tracing anything.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace test_closed_box {

using namespace dcem;
using namespace dcem::test;

namespace {

constexpr int highest_order = 10;
const Vec3 box_m(7.3, 5.1, 3.9);

/// Lengths of the paths of each order between two points in the box, by unfolding: the receiver's image in cell
/// (i, j, k) of the lattice is seen along a straight line that crosses |i| + |j| + |k| planes. With `lid` false a line
/// that crosses a copy of the plane z = height of the box meets nothing there, so it is no path.
std::map<int, std::vector<double>> lengths_by_unfolding(const Vec3& from_m, const Vec3& to_m, bool lid) {
  std::map<int, std::vector<double>> lengths;
  const auto image = [](double x, int cell, double size) {
    return cell % 2 == 0 ? cell * size + x : (cell + 1) * size - x;
  };
  const auto crosses_lid = [](double from, double to, double size) {
    for (int plane = -highest_order; plane <= highest_order + 1; ++plane) {
      const bool crossed = (from < plane * size) != (to < plane * size);
      if (crossed && plane % 2 != 0) return true;  // odd planes are copies of the lid, even ones of the floor
    }
    return false;
  };
  for (int i = -highest_order; i <= highest_order; ++i) {
    for (int j = -highest_order; j <= highest_order; ++j) {
      for (int k = -highest_order; k <= highest_order; ++k) {
        const int order = std::abs(i) + std::abs(j) + std::abs(k);
        if (order > highest_order) continue;
        const Vec3 end_m(image(to_m.x, i, box_m.x), image(to_m.y, j, box_m.y), image(to_m.z, k, box_m.z));
        if (!lid && crosses_lid(from_m.z, end_m.z, box_m.z)) continue;
        lengths[order].push_back(glm::distance(from_m, end_m));
      }
    }
  }
  for (auto& [order, of_order] : lengths) std::sort(of_order.begin(), of_order.end());
  return lengths;
}

void check_box(const Patches& patches, bool lid, const Vec3& from_m, const Vec3& to_m) {
  const auto expected = lengths_by_unfolding(from_m, to_m, lid);
  const auto paths = paths_between(scene_through_files(patches), from_m, to_m, law_settings(highest_order, 0));
  std::map<int, std::vector<double>> found;
  for (const PathContribution& path : paths) found[reflections(path)].push_back(path.path.length_m);
  for (int order = 0; order <= highest_order; ++order) {
    CAPTURE(order);
    std::vector<double>& lengths = found[order];
    std::sort(lengths.begin(), lengths.end());
    REQUIRE(lengths.size() == expected.at(order).size());
    // 1e-12: a length is the sum of up to 11 legs, each with a rounding error of a few 1e-16.
    for (std::size_t index = 0; index < lengths.size(); ++index) {
      CHECK(lengths[index] == doctest::Approx(expected.at(order)[index]).epsilon(1e-12));
    }
  }
}

}  // namespace

TEST_CASE("a closed box has 4N²+2 paths of order N, and their lengths are those of the image lattice") {
  const Patches box = box_faces(Vec3(0.0), box_m, "pec");
  const Vec3 from_m(1.237, 3.191, 1.413), to_m(5.711, 0.917, 2.639);
  const auto paths = paths_between(scene_through_files(box), from_m, to_m, law_settings(highest_order, 0));
  for (int order = 1; order <= highest_order; ++order) {
    CAPTURE(order);
    CHECK(std::count_if(paths.begin(), paths.end(), [&](const auto& path) { return reflections(path) == order; }) ==
          4 * order * order + 2);
  }
  check_box(box, true, from_m, to_m);
  check_box(box, true, Vec3(6.89, 4.77, 0.21), Vec3(0.31, 0.43, 3.62));
}

TEST_CASE("a box without its lid has the paths of the lattice that cross no copy of the lid") {
  Patches box = box_faces(Vec3(0.0), box_m, "opaque");
  box.pop_back();
  check_box(box, false, Vec3(1.237, 3.191, 1.413), Vec3(5.711, 0.917, 2.639));
  check_box(box, false, Vec3(2.03, 0.37, 3.71), Vec3(6.61, 4.27, 0.19));
}

TEST_CASE("every order limit up to 10 gives exactly the paths up to that order") {
  const Scene scene = scene_through_files(box_faces(Vec3(0.0), box_m, "pec"));
  for (int limit = 0; limit <= highest_order; ++limit) {
    std::size_t expected = 1;
    for (int order = 1; order <= limit; ++order) expected += static_cast<std::size_t>(4 * order * order + 2);
    CHECK(paths_between(scene, Vec3(1.2, 3.2, 1.4), Vec3(5.7, 0.9, 2.6), law_settings(limit, 0)).size() == expected);
  }
}

}  // namespace test_closed_box
