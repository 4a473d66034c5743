#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "dcem/debug/write_obj.hpp"

namespace test_write_obj {

using namespace dcem;

namespace {

/// A reader of `v`, `o` and `l` lines that resolves negative indices where they stand, as the format asks for.
struct Drawing {
  std::vector<std::string> objects;
  std::vector<Vec3> vertices_m;
  std::vector<std::vector<Vec3>> lines_m;
};

Drawing read(const std::string& text) {
  Drawing drawing;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword == "o") {
      words >> drawing.objects.emplace_back();
    } else if (keyword == "v") {
      Vec3& point = drawing.vertices_m.emplace_back();
      words >> point.x >> point.y >> point.z;
      REQUIRE(words);
    } else if (keyword == "l") {
      std::vector<Vec3>& points = drawing.lines_m.emplace_back();
      for (long index = 0; words >> index;) {
        REQUIRE(index < 0);
        points.push_back(drawing.vertices_m.at(drawing.vertices_m.size() - static_cast<std::size_t>(-index)));
      }
    } else {
      FAIL("unknown statement: " << line);
    }
  }
  return drawing;
}

Path two_bounces() {
  Path path;
  path.interactions = {{InteractionKind::reflection, FacetId(3U), Vec3(4, 5, 6)},
                       {InteractionKind::transmission, FacetId(1U), Vec3(7, 8, 9.5)}};
  return path;
}

}  // namespace

TEST_CASE("a path is one line from the transmitter over its points to the receiver") {
  std::ostringstream out;
  debug::write_path(out, two_bounces(), Vec3(1, 2, 3), Vec3(-1, 0, 10));
  const Drawing drawing = read(out.str());
  CHECK(drawing.objects == std::vector<std::string>{"path_RT"});
  REQUIRE(drawing.lines_m.size() == 1);
  CHECK(drawing.lines_m[0] == std::vector<Vec3>{Vec3(1, 2, 3), Vec3(4, 5, 6), Vec3(7, 8, 9.5), Vec3(-1, 0, 10)});
}

TEST_CASE("pieces may stand one after the other in one file") {
  std::ostringstream out;
  debug::write_path(out, two_bounces(), Vec3(1, 2, 3), Vec3(-1, 0, 10));
  debug::write_box(out, {Vec3(0), Vec3(1, 2, 3)});
  debug::write_path(out, Path{}, Vec3(1, 1, 1), Vec3(2, 2, 2));
  const Drawing drawing = read(out.str());
  CHECK(drawing.objects == std::vector<std::string>{"path_RT", "box", "path_LOS"});
  REQUIRE(drawing.lines_m.size() == 1 + 12 + 1);
  CHECK(drawing.lines_m.front().front() == Vec3(1, 2, 3));
  CHECK(drawing.lines_m.back() == std::vector<Vec3>{Vec3(1, 1, 1), Vec3(2, 2, 2)});
}

TEST_CASE("an edge is one line from start to end, named by its kind") {
  Wedge wedge;
  wedge.start_m = Vec3(1, 2, 3);
  wedge.end_m = Vec3(1, 2, 10.5);
  std::ostringstream out;
  debug::write_wedge(out, wedge);
  wedge.facets = {3, 7};
  debug::write_wedge(out, wedge);
  const Drawing drawing = read(out.str());
  CHECK(drawing.objects == std::vector<std::string>{"free_edge", "wedge"});
  REQUIRE(drawing.lines_m.size() == 2);
  for (const auto& line : drawing.lines_m) CHECK(line == std::vector<Vec3>{Vec3(1, 2, 3), Vec3(1, 2, 10.5)});
}

TEST_CASE("a box has eight corners and twelve edges, four along each axis, none twice") {
  std::ostringstream out;
  debug::write_box(out, {Vec3(-1, 0, 2), Vec3(1, 5, 10)});
  const Drawing drawing = read(out.str());
  CHECK(drawing.vertices_m.size() == 8);
  REQUIRE(drawing.lines_m.size() == 12);
  const Vec3 size(2, 5, 8);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 along(0.0);
    along[axis] = size[axis];
    CHECK(std::count_if(drawing.lines_m.begin(), drawing.lines_m.end(), [&](const std::vector<Vec3>& line) {
            return line.size() == 2 && (line[1] - line[0] == along || line[0] - line[1] == along);
          }) == 4);
  }
  for (std::size_t a = 0; a < 12; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      CHECK(drawing.lines_m[a] != drawing.lines_m[b]);
      CHECK(drawing.lines_m[a] != std::vector<Vec3>{drawing.lines_m[b][1], drawing.lines_m[b][0]});
    }
  }
}

TEST_CASE("a town's coordinates keep their millimetres") {
  std::ostringstream out;
  debug::write_path(out, Path{}, Vec3(12345.678, -9876.543, 1.25), Vec3(0.001, 500123.456, 10));
  const Drawing drawing = read(out.str());
  CHECK(glm::distance(drawing.vertices_m[0], Vec3(12345.678, -9876.543, 1.25)) < 1e-3);
  CHECK(glm::distance(drawing.vertices_m[1], Vec3(0.001, 500123.456, 10)) < 1e-3);
}

}  // namespace test_write_obj
