// In place of geos_outlines.cpp where there is no GEOS.
#include <stdexcept>

#include "dcem/io/src/import/outlines.hpp"

namespace dcem::io {

namespace {

[[noreturn]] void fail() {
  throw std::logic_error("outlines need GEOS; expected a caller that asks can_shape_outlines");
}

}  // namespace

bool can_shape_outlines() {
  return false;
}

std::string outline_library() {
  return "no GEOS (outlines of buildings)";
}

ShapedOutline shape_outline(const std::vector<Ring>&, const std::vector<Ring>&) {
  fail();
}

std::size_t snap_outlines(std::vector<Areas>&, double) {
  fail();
}

std::vector<PlanePiece> cut_plane(const std::vector<Areas>&) {
  fail();
}

Areas unite_pieces(const std::vector<Area>&) {
  fail();
}

void subtract_outlines(std::vector<Areas>&, const std::vector<Areas>&) {
  fail();
}

void part_corners(std::vector<Areas>&, const std::vector<Vec2>&, double) {
  fail();
}

std::vector<std::array<Vec2, 3>> triangulate(const Area&) {
  fail();
}

TurnedRectangle rectangle_around(const Ring&) {
  fail();
}

}  // namespace dcem::io
