#pragma once
/// Houses for make_town: closed shells with walls, boxed eaves, roof slopes, dormers and chimneys that share all their
/// edges. A house follows a middle line in the plan: straight, bent (L-shaped) or closed (around a courtyard). Lines
/// run along the axes of the house in tenths of a metre (see Placement).
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "scene_writer.hpp"

namespace example {

/// A point or direction in the plan, metres.
struct Plan {
  double x = 0.0, y = 0.0;
};
inline Plan operator+(Plan a, Plan b) {
  return {a.x + b.x, a.y + b.y};
}
inline Plan operator-(Plan a, Plan b) {
  return {a.x - b.x, a.y - b.y};
}
inline Plan operator*(Plan a, double s) {
  return {a.x * s, a.y * s};
}
inline double dot(Plan a, Plan b) {
  return a.x * b.x + a.y * b.y;
}
inline double length(Plan a) {
  return std::sqrt(dot(a, a));
}
inline Plan unit(Plan a) {
  return a * (1.0 / length(a));
}
inline Plan left_of(Plan a) {
  return {-a.y, a.x};
}
inline Point raised(Plan a, double z) {
  return {a.x, a.y, z};
}

/// How a building rises: rings of (distance from its middle line, height), from the foot of the wall to the ridge.
struct Profile {
  std::vector<std::array<double, 2>> rings;
  bool hipped = false;
};

inline Profile roofed(double half_depth_m, double eaves_m, double pitch, double overhang_m, bool hipped) {
  const double ridge_m = eaves_m + (half_depth_m + overhang_m) * pitch;
  return {{{half_depth_m, 0}, {half_depth_m, eaves_m}, {half_depth_m + overhang_m, eaves_m}, {0, ridge_m}}, hipped};
}

/// A mansard roof: steep (2 m inwards, 3.2 m up) to a knee, flat above it.
inline Profile mansard(double half_depth_m, double eaves_m) {
  const double knee = half_depth_m - 1.6, knee_z = eaves_m + 3.2;
  return {{{half_depth_m, 0},
           {half_depth_m, eaves_m},
           {half_depth_m + 0.4, eaves_m},
           {knee, knee_z},
           {0, knee_z + 0.4 * knee}},
          true};
}

inline const char* material_above(std::size_t ring) {
  return ring < 2 ? "wall" : "roof";
}

/// Roof parts on one slope, away from its ends: chimneys or dormers whose feet are cut into the slope.
enum class Extra { none, chimney, dormers };

/// One slope a-b (eaves) to d-c (ridge) with coordinates metres along the eaves and metres inwards.
struct Slope {
  Point a, b, c, d;

  double eaves_length_m() const { return length({b.x - a.x, b.y - a.y}); }
  Point at(double along_m, double inwards_m) const {
    const Plan along = unit({b.x - a.x, b.y - a.y}), inwards = left_of(along);
    const double steepness = (d.z - a.z) / dot({d.x - a.x, d.y - a.y}, inwards);
    return raised(Plan{a.x, a.y} + along * along_m + inwards * inwards_m, a.z + steepness * inwards_m);
  }
};

/// The nearest multiple of a step. Where two are equally near, the same one on every machine: hence not 0.5.
inline double snapped(double value, double step) {
  return step * std::floor(value / step + 0.4877);
}

inline Outline add_chimney(SceneWriter& scene, const Slope& slope, double along_m, double inwards_m) {
  const Outline foot{slope.at(along_m, inwards_m), slope.at(along_m + 0.9, inwards_m),
                     slope.at(along_m + 0.9, inwards_m + 0.6), slope.at(along_m, inwards_m + 0.6)};
  Outline top = foot;
  for (Point& corner : top) corner.z = slope.d.z + 0.9;
  for (std::size_t i = 0; i < 4; ++i) scene.face("wall", {foot[i], foot[(i + 1) % 4], top[(i + 1) % 4], top[i]});
  scene.face("wall", top);
  return foot;
}

/// A dormer with a shed roof: front, two cheeks and a roof that falls towards the street less steeply than the slope.
inline Outline add_dormer(SceneWriter& scene, const Slope& slope, double along_m) {
  const Outline foot{slope.at(along_m, 1.2), slope.at(along_m + 1.8, 1.2), slope.at(along_m + 1.8, 3.6),
                     slope.at(along_m, 3.6)};
  const double front_m = 0.65 * (foot[2].z - foot[1].z);
  const Point left{foot[0].x, foot[0].y, foot[0].z + front_m}, right{foot[1].x, foot[1].y, foot[1].z + front_m};
  scene.face("wall", {foot[0], foot[1], right, left});
  scene.face("wall", {foot[1], foot[2], right});
  scene.face("wall", {foot[3], foot[0], left});
  scene.face("roof", {left, right, foot[2], foot[3]});
  return foot;
}

inline void add_slope(SceneWriter& scene, const Slope& slope, double margin_m, Extra extra) {
  const double inner_m = slope.eaves_length_m() - 2.0 * margin_m;
  const double run_m = dot({slope.d.x - slope.a.x, slope.d.y - slope.a.y},
                           left_of(unit({slope.b.x - slope.a.x, slope.b.y - slope.a.y})));
  std::vector<Outline> holes;
  if (extra == Extra::chimney && inner_m > 1.45)
    holes.push_back(add_chimney(scene, slope, snapped(margin_m + 0.3 * inner_m, 0.1), run_m - 1.6));
  const int dormers = extra == Extra::dormers && run_m > 4.4 ? std::min(2, static_cast<int>(inner_m / 2.95)) : 0;
  for (int i = 0; i < dormers; ++i)
    holes.push_back(add_dormer(scene, slope, snapped(margin_m + inner_m * (i + 0.5) / dormers - 0.9, 0.1)));
  scene.face("roof", {slope.a, slope.b, slope.c, slope.d}, holes);
}

/// The corner of a line moved `side_m` to the left (mitred), and at an open end `end_m` outwards.
inline Plan moved(const std::vector<Plan>& line, bool closed, std::size_t i, double side_m, double end_m) {
  const std::size_t size = line.size();
  const bool first = !closed && i == 0, last = !closed && i + 1 == size;
  const Plan before = first ? Plan{} : unit(line[i] - line[(i + size - 1) % size]);
  const Plan after = last ? Plan{} : unit(line[(i + 1) % size] - line[i]);
  if (first) return line[i] + left_of(after) * side_m - after * end_m;
  if (last) return line[i] + left_of(before) * side_m + before * end_m;
  return line[i] + (left_of(before) + left_of(after)) * (side_m / (1.0 + dot(before, after)));
}

/// A building along a middle line: straight, bent (L) or closed (courtyard), with gables or hips at open ends.
/// \param extras  what stands on the right (street) and on the left slope
inline void add_building(SceneWriter& scene, const std::string& name, const Placement& placement,
                         const std::vector<Plan>& line, bool closed, const Profile& profile,
                         std::array<Extra, 2> extras = {Extra::none, Extra::none}) {
  scene.object(name, placement);
  const auto& rings = profile.rings;
  const std::size_t ridge = rings.size() - 1,
                    count = 2 * ridge + 1;  // points of a cross section, left foot to right foot
  std::vector<Outline> sections(line.size());
  for (std::size_t i = 0; i < line.size(); ++i)
    for (std::size_t k = 0; k < count; ++k) {
      const auto [offset_m, height_m] = rings[k <= ridge ? k : count - 1 - k];
      const double end_m = profile.hipped ? offset_m - rings[0][0] : 0.0;
      sections[i].push_back(raised(moved(line, closed, i, k <= ridge ? offset_m : -offset_m, end_m), height_m));
    }
  const double margin_m = line.size() > 2 || profile.hipped ? rings[ridge - 1][0] + 0.6 : 1.0;
  for (std::size_t i = 0; i + (closed ? 0 : 1) < line.size(); ++i) {
    const Outline &from = sections[i], &to = sections[(i + 1) % line.size()];
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const Outline quad{to[k], from[k], from[k + 1], to[k + 1]};
      if (k + 1 == ridge)
        add_slope(scene, {quad[0], quad[1], quad[2], quad[3]}, margin_m, extras[1]);
      else if (k == ridge)
        add_slope(scene, {quad[2], quad[3], quad[0], quad[1]}, margin_m, extras[0]);
      else
        scene.face(material_above(std::min(k, count - 2 - k)), quad);
    }
  }
  if (closed) return;
  Outline front = sections.front(), back = sections.back();
  std::reverse(front.begin(), front.end());
  for (const Outline& end : {front, back}) {
    if (!profile.hipped) scene.face("wall", end);
    for (std::size_t k = 0; profile.hipped && k < ridge; ++k) {
      Outline band{end[count - 1 - k], end[k], end[k + 1]};
      if (k + 1 < ridge) band.push_back(end[count - 2 - k]);
      scene.face(material_above(k), band);
    }
  }
}

/// A tower over a regular polygon with a pointed roof. The first corner looks along `turn_rad`.
inline void add_tower(SceneWriter& scene, const std::string& name, Plan centre, int sides, double radius_m,
                      double eaves_m, double top_m, double turn_rad) {
  scene.object(name);
  const auto corner = [&](int i, double distance_m, double height_m) {
    const double angle = turn_rad + 2.0 * std::numbers::pi * i / sides;
    return raised(centre + Plan{std::cos(angle), std::sin(angle)} * distance_m, height_m);
  };
  for (int i = 0; i < sides; ++i) {
    const int next = (i + 1) % sides;
    const Point from = corner(i, radius_m, eaves_m), to = corner(next, radius_m, eaves_m);
    const Point eaves_from = corner(i, radius_m + 0.5, eaves_m), eaves_to = corner(next, radius_m + 0.5, eaves_m);
    scene.face("wall", {corner(i, radius_m, 0), corner(next, radius_m, 0), to, from});
    scene.face("wall", {from, to, eaves_to, eaves_from});
    scene.face("roof", {eaves_from, eaves_to, raised(centre, top_m)});
  }
}

}  // namespace example
