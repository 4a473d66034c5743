#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/surfaces/welding.hpp"

namespace test_welding {

using namespace dcem;

namespace {

/// Transitive closeness the plain way: n² distances, relabelled until nothing changes.
std::vector<std::size_t> clusters(const std::vector<Vec3>& points, double tolerance_m) {
  std::vector<std::size_t> label(points.size());
  std::iota(label.begin(), label.end(), std::size_t{0});
  for (std::size_t a = 0; a < points.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (glm::distance(points[a], points[b]) > tolerance_m || label[a] == label[b]) continue;
      const std::size_t from = std::max(label[a], label[b]), to = std::min(label[a], label[b]);
      std::replace(label.begin(), label.end(), from, to);
    }
  }
  return label;
}

void check_against_plain(const std::vector<Vec3>& points, double tolerance_m) {
  const WeldedVertices welded = weld(points, tolerance_m);
  const std::vector<std::size_t> label = clusters(points, tolerance_m);
  REQUIRE(welded.new_index.size() == points.size());
  CHECK(std::is_sorted(welded.vertices_m.begin(), welded.vertices_m.end(), lexicographic_less));
  for (std::size_t a = 0; a < points.size(); ++a) {
    Vec3 smallest = points[a];
    for (std::size_t b = 0; b < points.size(); ++b) {
      CHECK_UNARY((welded.new_index[a] == welded.new_index[b]) == (label[a] == label[b]));
      if (label[a] == label[b] && lexicographic_less(points[b], smallest)) smallest = points[b];
    }
    CHECK_UNARY(welded.vertices_m[welded.new_index[a]] == smallest);
  }
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0);
}

}  // namespace

TEST_CASE("within the tolerance is one vertex, beyond it two") {
  for (const Vec3& at : {Vec3(0), Vec3(-3, 2, -1), Vec3(1e4, -1e4, 1e4)}) {
    for (const Vec3& along : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), glm::normalize(Vec3(1, -2, 3))}) {
      // At 10 km a coordinate has steps of 1.8e-12 m, a millionth of a percent of the tolerance.
      CHECK(weld({at, at + 0.999e-4 * along}, 1e-4).vertices_m.size() == 1);
      CHECK(weld({at, at + 1.001e-4 * along}, 1e-4).vertices_m.size() == 2);
    }
  }
}

TEST_CASE("vertices exactly as far apart as the tolerance are one vertex") {
  // Sums of powers of two: the distances are exact.
  for (const Vec3& along : {Vec3(0.125, 0, 0), Vec3(0, -0.125, 0), Vec3(0, 0, 0.125)}) {
    CHECK(weld({Vec3(1, -2, 3), Vec3(1, -2, 3) + along}, 0.125).vertices_m.size() == 1);
  }
}

TEST_CASE("a chain of close vertices is one vertex, its lexicographically smallest") {
  std::vector<Vec3> chain;
  for (int link = 0; link < 1000; ++link) chain.emplace_back(1.0 - 0.9e-4 * link, 5.0, -2.0);
  const WeldedVertices welded = weld(chain, 1e-4);
  REQUIRE(welded.vertices_m.size() == 1);
  CHECK(welded.vertices_m[0] == chain.back());
  chain.erase(chain.begin() + 500);  // a gap of 1.8e-4 parts it
  CHECK(weld(chain, 1e-4).vertices_m.size() == 2);
}

TEST_CASE("welding equals the plain n² definition: clouds, cell borders, negative coordinates, 10 km") {
  RandomStream random(10);
  for (int repeat = 0; repeat < 40; ++repeat) {
    const double tolerance_m = repeat % 2 == 0 ? 1e-4 : 0.125;
    const double far_m = repeat % 4 < 2 ? 0.0 : (repeat % 8 < 4 ? 1e4 : -1e4);
    const int steps = repeat % 3 == 0 ? 12 : 4;  // of half a tolerance: sparse or chained
    std::vector<Vec3> points;
    for (int index = 0; index < 150; ++index) {
      Vec3 point(far_m);
      for (int axis = 0; axis < 3; ++axis) {
        // On cell borders, or anywhere.
        const double halves = repeat % 5 == 0 ? 8.0 * steps * random.uniform()
                                              : static_cast<double>(random.next() % static_cast<unsigned>(4 * steps));
        point[axis] += 0.501 * tolerance_m * (halves - 2.0 * steps);
      }
      points.push_back(point);
    }
    check_against_plain(points, tolerance_m);
  }
}

TEST_CASE("tolerance 0 joins equal vertices only") {
  const double next = std::nextafter(1.0, 2.0);
  const WeldedVertices welded = weld({Vec3(1), Vec3(next, 1, 1), Vec3(1), Vec3(-1e4), Vec3(next, 1, 1)}, 0.0);
  CHECK(welded.vertices_m == std::vector<Vec3>{Vec3(-1e4), Vec3(1), Vec3(next, 1, 1)});
  CHECK(welded.new_index == std::vector<std::uint32_t>{1, 2, 1, 0, 2});
}

TEST_CASE("the order of the vertices changes no bit") {
  RandomStream random(11);
  std::vector<Vec3> points;
  for (int index = 0; index < 400; ++index) {
    Vec3 point(0.0);
    for (int axis = 0; axis < 3; ++axis) point[axis] = 0.4e-4 * (static_cast<double>(random.next() % 9) - 4.0);
    points.push_back(point);
  }
  const WeldedVertices expected = weld(points, 1e-4);
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (int repeat = 0; repeat < 10; ++repeat) {
    for (std::size_t last = order.size(); last > 1; --last) std::swap(order[last - 1], order[random.next() % last]);
    std::vector<Vec3> shuffled;
    for (const std::size_t index : order) shuffled.push_back(points[index]);
    const WeldedVertices welded = weld(shuffled, 1e-4);
    CHECK(same_bits(welded.vertices_m, expected.vertices_m));
    for (std::size_t index = 0; index < order.size(); ++index) {
      CHECK_UNARY(welded.new_index[index] == expected.new_index[order[index]]);
    }
  }
}

TEST_CASE("-0 and 0 are one coordinate: which of them stands for both does not depend on the order") {
  const std::vector<Vec3> one{Vec3(0.0, 1, 1), Vec3(-0.0, 1, 1)}, other{Vec3(-0.0, 1, 1), Vec3(0.0, 1, 1)};
  for (const double tolerance_m : {0.0, 1e-4}) {
    CHECK(weld(one, tolerance_m).vertices_m.size() == 1);
    CHECK(same_bits(weld(one, tolerance_m).vertices_m, weld(other, tolerance_m).vertices_m));
  }
}

TEST_CASE("nothing welds to nothing") {
  CHECK(weld({}, 1e-4).vertices_m.empty());
  CHECK(weld({Vec3(4, 5, 6)}, 1e-4).new_index == std::vector<std::uint32_t>{0});
}

TEST_CASE("a large plane of vertices is welded in well under the time of n² distances") {
  std::vector<Vec3> points;
  for (int x = 0; x < 300; ++x) {
    for (int y = 0; y < 300; ++y) {
      points.emplace_back(x, y, 0);
      points.emplace_back(x + 0.5e-4, y, 0);
    }
  }
  // 180 000 vertices: n² would be 3e10 distances, beyond the time limit of any test.
  CHECK(weld(points, 1e-4).vertices_m.size() == 90'000);
}

}  // namespace test_welding
