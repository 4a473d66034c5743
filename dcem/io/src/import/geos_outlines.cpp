// Outlines by GEOS (https://libgeos.org), through its C interface.
#include <geos_c.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "dcem/io/src/import/outlines.hpp"

namespace dcem::io {

namespace {

void keep_message(const char* message, void* kept) {
  *static_cast<std::string*>(kept) = message;
}

/// One context for a thread: GEOS keeps its messages there.
struct Context {
  Context() : handle(GEOS_init_r()) { GEOSContext_setErrorMessageHandler_r(handle, &keep_message, &message); }
  ~Context() { GEOS_finish_r(handle); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  GEOSContextHandle_t handle;
  std::string message;
};

Context& context() {
  thread_local Context kept;
  return kept;
}

GEOSContextHandle_t geos() {
  return context().handle;
}

struct Release {
  void operator()(GEOSGeometry* shape) const { GEOSGeom_destroy_r(geos(), shape); }
  void operator()(const GEOSPreparedGeometry* shape) const { GEOSPreparedGeom_destroy_r(geos(), shape); }
  void operator()(GEOSSTRtree* tree) const { GEOSSTRtree_destroy_r(geos(), tree); }
};
using Shape = std::unique_ptr<GEOSGeometry, Release>;
using PreparedShape = std::unique_ptr<const GEOSPreparedGeometry, Release>;

/// What GEOS gave; throws where it gave nothing.
Shape made(GEOSGeometry* shape) {
  if (shape == nullptr) throw std::runtime_error("GEOS: " + context().message);
  return Shape(shape);
}

GEOSCoordSequence* coordinates(const Ring& ring) {
  std::vector<double> x_m, y_m;
  for (const Vec2& corner : ring) {
    x_m.push_back(corner.x);
    y_m.push_back(corner.y);
  }
  x_m.push_back(ring.front().x);
  y_m.push_back(ring.front().y);
  return GEOSCoordSeq_copyFromArrays_r(geos(), x_m.data(), y_m.data(), nullptr, nullptr,
                                       static_cast<unsigned>(x_m.size()));
}

Shape linear_ring(const Ring& ring) {
  return made(GEOSGeom_createLinearRing_r(geos(), coordinates(ring)));
}

Shape polygon(const Area& area) {
  std::vector<GEOSGeometry*> holes;
  for (const Ring& hole : area.holes) holes.push_back(linear_ring(hole).release());
  return made(GEOSGeom_createPolygon_r(geos(), linear_ring(area.outer).release(), holes.data(),
                                       static_cast<unsigned>(holes.size())));
}

Shape collection(std::vector<Shape>&& shapes, int type) {
  std::vector<GEOSGeometry*> raw;
  for (Shape& shape : shapes) raw.push_back(shape.release());
  return made(GEOSGeom_createCollection_r(geos(), type, raw.data(), static_cast<unsigned>(raw.size())));
}

Shape multipolygon(const Areas& areas) {
  std::vector<Shape> polygons;
  for (const Area& area : areas) polygons.push_back(polygon(area));
  return collection(std::move(polygons), GEOS_MULTIPOLYGON);
}

Ring ring_of(const GEOSGeometry* line, bool counterclockwise) {
  const GEOSCoordSequence* const sequence = GEOSGeom_getCoordSeq_r(geos(), line);
  unsigned count = 0;
  GEOSCoordSeq_getSize_r(geos(), sequence, &count);
  Ring ring;
  for (unsigned index = 0; index + 1 < count; ++index) {
    Vec2 corner(0.0);
    GEOSCoordSeq_getXY_r(geos(), sequence, index, &corner.x, &corner.y);
    if (ring.empty() || ring.back() != corner) ring.push_back(corner);
  }
  if ((signed_area_m2(ring) > 0.0) != counterclockwise) std::reverse(ring.begin(), ring.end());
  return ring;
}

Area area_of(const GEOSGeometry* polygon) {
  Area area{ring_of(GEOSGetExteriorRing_r(geos(), polygon), true), {}};
  const int holes = GEOSGetNumInteriorRings_r(geos(), polygon);
  for (int hole = 0; hole < holes; ++hole) {
    area.holes.push_back(ring_of(GEOSGetInteriorRingN_r(geos(), polygon, hole), false));
  }
  return area;
}

/// All polygons in a shape of whatever kind; lines and points are left out.
void collect_areas(const GEOSGeometry* shape, Areas& areas) {
  const int type = GEOSGeomTypeId_r(geos(), shape);
  if (type == GEOS_POLYGON) {
    if (GEOSisEmpty_r(geos(), shape) == 0) areas.push_back(area_of(shape));
    return;
  }
  if (type != GEOS_MULTIPOLYGON && type != GEOS_GEOMETRYCOLLECTION) return;
  const int parts = GEOSGetNumGeometries_r(geos(), shape);
  for (int part = 0; part < parts; ++part) collect_areas(GEOSGetGeometryN_r(geos(), shape, part), areas);
}

Areas areas_of(const Shape& shape) {
  Areas areas;
  collect_areas(shape.get(), areas);
  return areas;
}

bool is_valid(const Shape& shape) {
  return GEOSisValid_r(geos(), shape.get()) == 1;
}

/// Rings that cross themselves become what lies inside of them.
Shape mended(Shape shape) {
  if (is_valid(shape)) return shape;
  GEOSMakeValidParams* const parameters = GEOSMakeValidParams_create_r(geos());
  GEOSMakeValidParams_setMethod_r(geos(), parameters, GEOS_MAKE_VALID_STRUCTURE);
  GEOSMakeValidParams_setKeepCollapsed_r(geos(), parameters, 0);
  GEOSGeometry* const valid = GEOSMakeValidWithParams_r(geos(), shape.get(), parameters);
  GEOSMakeValidParams_destroy_r(geos(), parameters);
  return made(valid);
}

/// The union of what the rings enclose.
Shape inside_of(const std::vector<Ring>& rings, bool& was_crossed) {
  std::vector<Shape> polygons;
  for (const Ring& ring : rings) {
    Shape shape = polygon({ring, {}});
    if (!is_valid(shape)) was_crossed = true;
    for (const Area& area : areas_of(mended(std::move(shape)))) polygons.push_back(polygon(area));
  }
  return made(GEOSUnaryUnion_r(geos(), collection(std::move(polygons), GEOS_GEOMETRYCOLLECTION).get()));
}

/// Which of many boxes meet a box.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Shape>& shapes) : tree_(GEOSSTRtree_create_r(geos(), 10)) {
    indices_.reserve(shapes.size());
    for (std::size_t index = 0; index < shapes.size(); ++index) {
      indices_.push_back(index);
      if (GEOSisEmpty_r(geos(), shapes[index].get()) != 0) continue;
      GEOSSTRtree_insert_r(geos(), tree_.get(), shapes[index].get(), &indices_.back());
    }
  }

  /// Ascending.
  std::vector<std::size_t> near(const GEOSGeometry* shape, double margin_m) const {
    std::vector<std::size_t> found;
    if (GEOSisEmpty_r(geos(), shape) != 0) return found;
    double x_low = 0.0, y_low = 0.0, x_high = 0.0, y_high = 0.0;
    GEOSGeom_getXMin_r(geos(), shape, &x_low);
    GEOSGeom_getYMin_r(geos(), shape, &y_low);
    GEOSGeom_getXMax_r(geos(), shape, &x_high);
    GEOSGeom_getYMax_r(geos(), shape, &y_high);
    const Ring box{{x_low - margin_m, y_low - margin_m},
                   {x_high + margin_m, y_low - margin_m},
                   {x_high + margin_m, y_high + margin_m},
                   {x_low - margin_m, y_high + margin_m}};
    GEOSSTRtree_query_r(geos(), tree_.get(), linear_ring(box).get(), &note, &found);
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  static void note(void* index, void* found) {
    static_cast<std::vector<std::size_t>*>(found)->push_back(*static_cast<std::size_t*>(index));
  }

  std::unique_ptr<GEOSSTRtree, Release> tree_;
  std::vector<std::size_t> indices_;
};

std::vector<Shape> shapes_of(const std::vector<Areas>& outlines) {
  std::vector<Shape> shapes;
  for (const Areas& areas : outlines) shapes.push_back(multipolygon(areas));
  return shapes;
}

Shape copy_of(const Shape& shape) {
  return made(GEOSGeom_clone_r(geos(), shape.get()));
}

/// Snaps a shape to those of its neighbours that `counts`.
template <typename Counts>
void snap_to_neighbours(std::vector<Shape>& shapes, const BoxTree& tree, std::size_t index, double tolerance_m,
                        const Counts& counts) {
  std::vector<Shape> neighbours;
  for (const std::size_t other : tree.near(shapes[index].get(), tolerance_m)) {
    if (other != index && counts(other)) neighbours.push_back(copy_of(shapes[other]));
  }
  if (neighbours.empty()) return;
  const Shape around = collection(std::move(neighbours), GEOS_GEOMETRYCOLLECTION);
  GEOSGeometry* const snapped = GEOSSnap_r(geos(), shapes[index].get(), around.get(), tolerance_m);
  if (snapped != nullptr) shapes[index] = mended(Shape(snapped));  // what cannot be snapped stays where it is
}

std::vector<std::size_t> outlines_around(const GEOSGeometry* point, const BoxTree& tree,
                                         const std::vector<PreparedShape>& prepared) {
  std::vector<std::size_t> around;
  for (const std::size_t index : tree.near(point, 0.0)) {
    if (GEOSPreparedIntersects_r(geos(), prepared[index].get(), point) == 1) around.push_back(index);
  }
  return around;
}

}  // namespace

bool can_shape_outlines() {
  return true;
}

std::string outline_library() {
  const std::string version = GEOSversion();  // "3.11.1-CAPI-1.17.1"
  return "GEOS " + version.substr(0, version.find('-'));
}

ShapedOutline shape_outline(const std::vector<Ring>& outers, const std::vector<Ring>& inners) {
  constexpr double corner_worth_m = 0.02;
  ShapedOutline result;
  Shape shape = inside_of(outers, result.was_crossed);
  if (!inners.empty()) {
    const Shape holes = inside_of(inners, result.was_crossed);
    shape = made(GEOSDifference_r(geos(), shape.get(), holes.get()));
  }
  shape = mended(made(GEOSTopologyPreserveSimplify_r(geos(), shape.get(), corner_worth_m)));
  result.areas = areas_of(shape);
  return result;
}

std::size_t snap_outlines(std::vector<Areas>& outlines, double tolerance_m) {
  std::vector<Shape> shapes = shapes_of(outlines);
  const BoxTree tree(shapes);  // of the outlines as they came: they move by less than the margin
  // First each goes to those before it, so that corners become one; then edges take in the corners of all others.
  for (std::size_t index = 0; index < shapes.size(); ++index) {
    snap_to_neighbours(shapes, tree, index, tolerance_m, [&](std::size_t other) { return other < index; });
  }
  for (std::size_t index = 0; index < shapes.size(); ++index) {
    snap_to_neighbours(shapes, tree, index, tolerance_m, [](std::size_t) { return true; });
  }
  std::size_t changed = 0;
  for (std::size_t index = 0; index < shapes.size(); ++index) {
    Areas snapped = areas_of(shapes[index]);
    if (snapped == outlines[index]) continue;
    outlines[index] = std::move(snapped);
    ++changed;
  }
  return changed;
}

std::vector<PlanePiece> cut_plane(const std::vector<Areas>& outlines) {
  std::vector<Shape> rims;
  for (const Areas& areas : outlines) {
    for (const Area& area : areas) {
      rims.push_back(linear_ring(area.outer));
      for (const Ring& hole : area.holes) rims.push_back(linear_ring(hole));
    }
  }
  std::vector<PlanePiece> pieces;
  if (rims.empty()) return pieces;
  const Shape lines = collection(std::move(rims), GEOS_GEOMETRYCOLLECTION);
  const Shape noded = made(GEOSUnaryUnionPrec_r(geos(), lines.get(), outline_grid_m));
  const GEOSGeometry* const all = noded.get();
  const Shape cells = made(GEOSPolygonize_r(geos(), &all, 1));

  const std::vector<Shape> shapes = shapes_of(outlines);
  const BoxTree tree(shapes);
  std::vector<PreparedShape> prepared;
  for (const Shape& shape : shapes) prepared.emplace_back(GEOSPrepare_r(geos(), shape.get()));
  const int count = GEOSGetNumGeometries_r(geos(), cells.get());
  for (int cell = 0; cell < count; ++cell) {
    const GEOSGeometry* const shape = GEOSGetGeometryN_r(geos(), cells.get(), cell);
    const Shape point = made(GEOSPointOnSurface_r(geos(), shape));
    pieces.push_back({area_of(shape), outlines_around(point.get(), tree, prepared)});
  }
  return pieces;
}

Areas unite_pieces(const std::vector<Area>& pieces) {
  return areas_of(made(GEOSCoverageUnion_r(geos(), multipolygon(pieces).get())));
}

void subtract_outlines(std::vector<Areas>& outlines, const std::vector<Areas>& others) {
  const std::vector<Shape> holes = shapes_of(others);
  const BoxTree tree(holes);
  for (Areas& outline : outlines) {
    Shape shape = multipolygon(outline);
    const std::vector<std::size_t> near = tree.near(shape.get(), 0.0);
    if (near.empty()) continue;
    for (const std::size_t index : near) shape = made(GEOSDifference_r(geos(), shape.get(), holes[index].get()));
    outline = areas_of(shape);
  }
}

void part_corners(std::vector<Areas>& outlines, const std::vector<Vec2>& points_m, double radius_m) {
  std::vector<Areas> octagons;
  for (const Vec2& point_m : points_m) {
    Ring octagon;
    for (int corner = 0; corner < 8; ++corner) {
      const double angle_rad = (0.5 + corner) * std::numbers::pi / 4.0;
      octagon.push_back(point_m + radius_m * Vec2(std::cos(angle_rad), std::sin(angle_rad)));
    }
    octagons.push_back({{octagon, {}}});
  }
  subtract_outlines(outlines, octagons);
}

std::vector<std::array<Vec2, 3>> triangulate(const Area& area) {
  const Shape cells = made(GEOSConstrainedDelaunayTriangulation_r(geos(), polygon(area).get()));
  std::vector<std::array<Vec2, 3>> triangles;
  for (const Area& cell : areas_of(cells)) {
    if (cell.outer.size() == 3) triangles.push_back({cell.outer[0], cell.outer[1], cell.outer[2]});
  }
  return triangles;
}

TurnedRectangle rectangle_around(const Ring& ring) {
  const Shape box = made(GEOSMinimumRotatedRectangle_r(geos(), linear_ring(ring).get()));
  if (GEOSGeomTypeId_r(geos(), box.get()) != GEOS_POLYGON) return {};
  const Ring corners = area_of(box.get()).outer;
  if (corners.size() != 4) return {};
  Vec2 length = corners[1] - corners[0], width = corners[2] - corners[1];
  if (glm::length(length) < glm::length(width)) std::swap(length, width);
  double yaw_rad = std::atan2(length.y, length.x);
  if (yaw_rad < 0.0) yaw_rad += std::numbers::pi;
  return {0.5 * (corners[0] + corners[2]), glm::length(length), glm::length(width),
          yaw_rad < std::numbers::pi ? yaw_rad : 0.0};
}

}  // namespace dcem::io
