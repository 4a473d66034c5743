#include "dcem/io/src/import/town_mesh.hpp"

#include <array>
#include <map>
#include <set>
#include <stdexcept>

#include "dcem/io/src/import/plan_corners.hpp"

namespace dcem::io {

namespace {

using GridEdge = std::pair<GridCorner, GridCorner>;

/// Which part is to the left of each edge, and at which heights something ends at each corner.
class TownEdges {
 public:
  explicit TownEdges(const std::vector<TownPart>& parts) {
    for (const TownPart& part : parts) {
      for (const Area& area : part.areas) {
        for_each_edge(area, [&](const Vec2& from, const Vec2& to) {
          left_of_[{grid_corner(from), grid_corner(to)}] = &part;
        });
      }
    }
    for (const auto& [edge, part] : left_of_) {
      for (const GridCorner& corner : {edge.first, edge.second}) {
        levels_m_[corner].insert({part->top_m, beyond_m(edge)});
      }
    }
  }

  /// How high it is on the other side: the neighbour's roof, or in the open the own foot. Precondition: an edge of a
  /// part.
  double beyond_m(const GridEdge& edge) const {
    const auto found = left_of_.find({edge.second, edge.first});
    return found == left_of_.end() ? left_of_.at(edge)->foot_m : found->second->top_m;
  }

  /// The heights from `low_m` to `high_m` at which an upright edge at this corner is divided, both included.
  std::vector<double> levels_m(const GridCorner& corner, double low_m, double high_m) const {
    std::vector<double> levels{low_m};
    for (const double level_m : levels_m_.at(corner)) {
      if (level_m > low_m && level_m < high_m) levels.push_back(level_m);
    }
    levels.push_back(high_m);
    return levels;
  }

 private:
  std::map<GridEdge, const TownPart*> left_of_;
  std::map<GridCorner, std::set<double>> levels_m_;
};

/// A wall between two upright edges that are divided independently.
void add_wall(const Vec2& from, const Vec2& to, const std::vector<double>& from_levels_m,
              const std::vector<double>& to_levels_m, const std::string& material, ObjDraft& obj) {
  std::size_t i = 0, j = 0;
  while (i + 1 < from_levels_m.size() || j + 1 < to_levels_m.size()) {
    const bool goes_up_there =
        i + 1 == from_levels_m.size() || (j + 1 < to_levels_m.size() && to_levels_m[j + 1] <= from_levels_m[i + 1]);
    const Vec3 a(from.x, from.y, from_levels_m[i]), b(to.x, to.y, to_levels_m[j]);
    const Vec3 next = goes_up_there ? Vec3(to.x, to.y, to_levels_m[++j]) : Vec3(from.x, from.y, from_levels_m[++i]);
    obj.face(material, {a, b, next});
  }
}

void add_walls(const TownPart& part, const Area& area, const TownEdges& edges, ObjDraft& obj, ImportReport& report) {
  for_each_edge(area, [&](const Vec2& from, const Vec2& to) {
    const GridEdge edge{grid_corner(from), grid_corner(to)};
    const double low_m = edges.beyond_m(edge);
    if (low_m >= part.top_m) return;
    ++report.made[low_m > part.foot_m ? "steps between roofs" : "outer walls"];
    add_wall(from, to, edges.levels_m(edge.first, low_m, part.top_m), edges.levels_m(edge.second, low_m, part.top_m),
             part.wall, obj);
  });
}

/// How many triangles use every corner of an area, by Euler's formula; a hole may touch the rim in a corner.
std::size_t triangle_count(const Area& area) {
  std::set<GridCorner> corners;
  std::size_t edges = 0;
  for_each_edge(area, [&](const Vec2& from, const Vec2&) {
    corners.insert(grid_corner(from));
    ++edges;
  });
  return 2 * corners.size() + 2 * area.holes.size() - edges - 2;
}

void add_roof(const TownPart& part, const Area& area, Foot foot, ObjDraft& obj) {
  const auto triangles = triangulate(area);
  if (triangles.size() != triangle_count(area)) {
    throw std::runtime_error("roof of '" + part.id + "': " + std::to_string(triangles.size()) + " triangles, not " +
                             std::to_string(triangle_count(area)));
  }
  for (const std::array<Vec2, 3>& flat : triangles) {
    const auto at = [&](const Vec2& corner, double height_m) { return Vec3(corner.x, corner.y, height_m); };
    obj.face(part.roof, {at(flat[0], part.top_m), at(flat[1], part.top_m), at(flat[2], part.top_m)});
    if (foot == Foot::closed)
      obj.face(part.wall, {at(flat[2], part.foot_m), at(flat[1], part.foot_m), at(flat[0], part.foot_m)});
  }
}

}  // namespace

void add_town(const std::vector<TownPart>& parts, Foot foot, ObjDraft& obj, ImportReport& report) {
  const TownEdges edges(parts);
  for (const TownPart& part : parts) {
    obj.start_group(part.id);
    for (const Area& area : part.areas) {
      add_roof(part, area, foot, obj);
      add_walls(part, area, edges, obj, report);
      ++report.made["roofs"];
      report.sizes["footprint_area_m2"] += area_m2(area);
      report.sizes["volume_m3"] += area_m2(area) * (part.top_m - part.foot_m);
    }
  }
}

void add_flat_ground(const Vec2& low_m, const Vec2& high_m, ObjDraft& obj) {
  obj.start_group("ground");
  obj.face("ground",
           {{low_m.x, low_m.y, 0.0}, {high_m.x, low_m.y, 0.0}, {high_m.x, high_m.y, 0.0}, {low_m.x, high_m.y, 0.0}});
}

}  // namespace dcem::io
