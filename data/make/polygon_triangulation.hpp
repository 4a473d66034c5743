#pragma once
/// Cuts a flat polygon with holes into triangles that use its corners only: holes are joined to the boundary by
/// bridges, ears are cut off, and diagonals are flipped until no flip makes a better pair of triangles.
///
/// Coordinates are integers, so every decision about sides is exact.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

namespace example {

/// A corner of a polygon projected on a coordinate plane, in ticks, with its vertex number.
struct Corner {
  std::int64_t u, v;
  std::size_t vertex;

  bool at(const Corner& other) const { return u == other.u && v == other.v; }
};
using Ring = std::vector<Corner>;

/// Twice the signed area of a triangle, exact: positive if counterclockwise.
inline std::int64_t turn(const Corner& a, const Corner& b, const Corner& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

inline int side(const Corner& a, const Corner& b, const Corner& c) {
  const std::int64_t area = turn(a, b, c);
  return (area > 0) - (area < 0);
}

inline double squared_distance(const Corner& a, const Corner& b) {
  const auto du = static_cast<double>(a.u - b.u), dv = static_cast<double>(a.v - b.v);
  return du * du + dv * dv;
}

/// Two corners and a line nearer than this (2 mm) count as touching: the corners of a tilted face are rounded.
constexpr double touching_ticks = 20.0;

/// Shapes nearer than this share count as equal, so that the last bit of a machine decides nothing.
constexpr double tie = 1e-9;

/// Whether p touches the stretch a-b between its ends.
inline bool touches(const Corner& a, const Corner& b, const Corner& p) {
  const double square = squared_distance(a, b), off = static_cast<double>(turn(a, b, p));
  const auto along = static_cast<double>((p.u - a.u) * (b.u - a.u) + (p.v - a.v) * (b.v - a.v));
  return off * off <= touching_ticks * touching_ticks * square && 0.0 < along && along < square;
}

/// Whether the edge c-d keeps the diagonal a-b from being drawn. A shared end alone does not.
inline bool blocks(const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  if (touches(a, b, c) || touches(a, b, d)) return true;
  if (c.at(a) || c.at(b) || d.at(a) || d.at(b)) return false;
  const int of_c = side(a, b, c), of_d = side(a, b, d);
  return (of_c != 0 || of_d != 0) && of_c * of_d <= 0 && side(c, d, a) * side(c, d, b) <= 0;
}

inline bool blocks(const Ring& ring, const Corner& a, const Corner& b) {
  for (std::size_t i = 0; i < ring.size(); ++i)
    if (blocks(a, b, ring[i], ring[(i + 1) % ring.size()])) return true;
  return false;
}

/// Whether the direction from ring[i] to `target` starts into the inside of the ring.
inline bool opens_inside(const Ring& ring, std::size_t i, const Corner& target) {
  const Corner &here = ring[i], &next = ring[(i + 1) % ring.size()], &last = ring[(i + ring.size() - 1) % ring.size()];
  if (turn(last, here, next) > 0) return turn(here, next, target) > 0 && turn(last, here, target) > 0;
  return turn(here, next, target) > 0 || turn(last, here, target) > 0;
}

/// Joins a hole to the ring that encloses it by the shortest bridge that crosses nothing.
inline void join_hole(Ring& ring, const std::vector<Ring>& holes, std::size_t which) {
  const Ring& hole = holes[which];
  double best = -1.0;
  std::pair<std::size_t, std::size_t> bridge;
  for (std::size_t i = 0; i < ring.size(); ++i)
    for (std::size_t j = 0; j < hole.size(); ++j) {
      const double length = squared_distance(ring[i], hole[j]);
      if ((best >= 0.0 && length >= best) || !opens_inside(ring, i, hole[j]) || blocks(ring, ring[i], hole[j]))
        continue;
      bool crossed = false;
      for (std::size_t k = which; k < holes.size(); ++k) crossed = crossed || blocks(holes[k], ring[i], hole[j]);
      if (!crossed) best = length, bridge = {i, j};
    }
  if (best < 0.0) throw std::logic_error("a hole lies outside its polygon");
  Ring path;
  for (std::size_t j = 0; j <= hole.size(); ++j) path.push_back(hole[(bridge.second + j) % hole.size()]);
  path.push_back(ring[bridge.first]);
  ring.insert(ring.begin() + static_cast<std::ptrdiff_t>(bridge.first) + 1, path.begin(), path.end());
}

/// Shape of a triangle, larger if better: twice the area over the square of the longest side. 0 if it is (nearly) flat.
inline double shape(const Corner& a, const Corner& b, const Corner& c) {
  const double longest_square = std::max({squared_distance(a, b), squared_distance(b, c), squared_distance(c, a)});
  const auto area = static_cast<double>(turn(a, b, c));
  return area > touching_ticks * std::sqrt(longest_square) ? area / longest_square : 0.0;
}

/// Shape of the triangle that cutting corner i off would give, or 0 if it is no ear.
inline double ear_quality(const Ring& ring, std::size_t i) {
  const std::size_t size = ring.size(), before = (i + size - 1) % size, after = (i + 1) % size;
  if (size > 3 && (!opens_inside(ring, before, ring[after]) || !opens_inside(ring, after, ring[before]) ||
                   blocks(ring, ring[before], ring[after])))
    return 0.0;
  return shape(ring[before], ring[i], ring[after]);
}

using CornerTriangle = std::array<Corner, 3>;

inline std::vector<CornerTriangle> cut_ears(Ring ring) {
  std::vector<CornerTriangle> triangles;
  while (ring.size() >= 3) {
    std::size_t best = 0;
    double quality = 0.0;
    for (std::size_t i = 0; i < ring.size(); ++i)
      if (const double found = ear_quality(ring, i); found > quality * (1.0 + tie)) quality = found, best = i;
    if (quality == 0.0) throw std::logic_error("a polygon cannot be cut into triangles: check its corners");
    triangles.push_back({ring[(best + ring.size() - 1) % ring.size()], ring[best], ring[(best + 1) % ring.size()]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(best));
  }
  return triangles;
}

/// Flips one diagonal if the worse of its two triangles becomes better; false if there is none left.
inline bool flip_one(std::vector<CornerTriangle>& triangles) {
  std::map<std::pair<std::size_t, std::size_t>, std::array<std::size_t, 2>> edges;  // -> triangle, its corner opposite
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const Corner from = triangles[t][k], to = triangles[t][(k + 1) % 3], top = triangles[t][(k + 2) % 3];
      const auto twin = edges.find({to.vertex, from.vertex});
      edges[{from.vertex, to.vertex}] = {t, (k + 2) % 3};
      if (twin == edges.end()) continue;
      const auto [other, opposite] = twin->second;
      const Corner bottom = triangles[other][opposite];
      const double now = std::min(shape(from, to, top), shape(to, from, bottom));
      if (std::min(shape(bottom, to, top), shape(top, from, bottom)) <= now * (1.0 + tie)) continue;
      triangles[t] = {bottom, to, top};
      triangles[other] = {top, from, bottom};
      return true;
    }
  return false;
}

inline std::int64_t signed_area(const Ring& ring) {
  std::int64_t area = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) area += turn(ring[0], ring[i], ring[i + 1]);
  return area;
}

/// The vertex numbers of the triangles of a polygon with holes, counterclockwise, whatever the winding of the rings.
inline std::vector<std::array<std::size_t, 3>> triangulate(Ring ring, std::vector<Ring> holes) {
  if (signed_area(ring) < 0) std::reverse(ring.begin(), ring.end());
  for (Ring& hole : holes)
    if (signed_area(hole) > 0) std::reverse(hole.begin(), hole.end());
  for (std::size_t i = 0; i < holes.size(); ++i) join_hole(ring, holes, i);
  std::vector<CornerTriangle> triangles = cut_ears(std::move(ring));
  while (flip_one(triangles)) {
  }
  std::vector<std::array<std::size_t, 3>> numbers;
  for (const CornerTriangle& t : triangles) numbers.push_back({t[0].vertex, t[1].vertex, t[2].vertex});
  return numbers;
}

}  // namespace example
