#pragma once
/// Writes clean OBJ + MTL scenes for the programs make_town, make_crossing and make_office.
///
/// Coordinates are kept as whole tenths of a millimetre, so vertices that should coincide do so exactly, the
/// triangulation decides with integers only, and every run on every machine writes the same bytes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "polygon_triangulation.hpp"

namespace example {

/// A point in metres, z up.
struct Point {
  double x = 0.0, y = 0.0, z = 0.0;
};

/// Corners of a flat polygon; an outer boundary runs counterclockwise seen from the outside of the body.
using Outline = std::vector<Point>;

/// Where the local origin and the local x axis of an object lie in the plan. If the axis is written in thousandths and
/// the object in tenths of a metre, turned objects stay exact: their flat faces are flat to the last digit.
struct Placement {
  double x = 0.0, y = 0.0;
  double along_x = 1.0, along_y = 0.0;
};

/// Collects faces in named objects and writes them as NAME.obj with NAME.mtl.
class SceneWriter {
 public:
  /// \param materials  the text of the .mtl file
  explicit SceneWriter(std::string materials) : materials_(std::move(materials)) {}

  /// Faces that follow belong to this object; their points are in its local axes.
  void object(const std::string& name, const Placement& placement = {}) {
    placement_ = placement;
    faces_ += "o " + name + "\n";
    material_.clear();
    ++objects_;
  }

  /// Adds a flat polygon with holes as triangles that share their edges and use the given corners only.
  void face(const std::string& material, const Outline& outline, const std::vector<Outline>& holes = {}) {
    if (material != material_) faces_ += "usemtl " + material + "\n";
    material_ = material;
    const std::size_t dropped = dominant_axis(outline);
    Ring ring = project(outline, dropped);
    const bool mirrored = signed_area(ring) < 0;
    std::vector<Ring> inner;
    for (const Outline& hole : holes) inner.push_back(project(hole, dropped));
    for (auto [first, second, third] : triangulate(ring, inner)) {
      if (mirrored) std::swap(first, third);
      faces_ += "f " + std::to_string(first) + " " + std::to_string(second) + " " + std::to_string(third) + "\n";
      ++triangles_;
    }
  }

  std::size_t object_count() const { return objects_; }
  std::size_t triangle_count() const { return triangles_; }

  void write(const std::filesystem::path& folder, const std::string& name, const std::string& comment) const {
    std::filesystem::create_directories(folder);
    save(folder / (name + ".mtl"), materials_);
    save(folder / (name + ".obj"), "# " + comment + "\n# metres, z up\nmtllib " + name + ".mtl\n" + vertices_ + faces_);
  }

 private:
  static constexpr double ticks_per_metre = 1e4;
  using Ticks = std::array<std::int64_t, 3>;

  static Ticks to_ticks(const Point& p) {
    return {std::llround(p.x * ticks_per_metre), std::llround(p.y * ticks_per_metre),
            std::llround(p.z * ticks_per_metre)};
  }

  Point placed(const Point& p) const {
    const auto [x, y, along_x, along_y] = placement_;
    return {x + along_x * p.x - along_y * p.y, y + along_y * p.x + along_x * p.y, p.z};
  }

  static std::string decimal(std::int64_t ticks) {
    std::string digits = std::to_string(std::abs(ticks));
    if (digits.size() < 5) digits.insert(0, 5 - digits.size(), '0');
    digits.insert(digits.size() - 4, ".");
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') digits.pop_back();
    return (ticks < 0 ? "-" : "") + digits;
  }

  /// The axis along which the polygon shows its largest area (0, 1, 2 for x, y, z).
  static std::size_t dominant_axis(const Outline& outline) {
    std::array<double, 3> area{};
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const Point &a = outline[i], &b = outline[(i + 1) % outline.size()];
      area[0] += a.y * b.z - a.z * b.y;
      area[1] += a.z * b.x - a.x * b.z;
      area[2] += a.x * b.y - a.y * b.x;
    }
    std::size_t axis = 0;
    for (const std::size_t other : {1u, 2u})  // a clear lead only: the last bit of a machine decides nothing
      if (std::abs(area[other]) > std::abs(area[axis]) * (1.0 + 1e-9)) axis = other;
    return axis;
  }

  /// Numbers the corners of a polygon and gives their local coordinates across the dropped axis.
  Ring project(const Outline& outline, std::size_t dropped) {
    Ring ring;
    for (const Point& point : outline) {
      const Ticks local = to_ticks(point), world = to_ticks(placed(point));
      const auto [entry, is_new] = numbers_.emplace(world, numbers_.size() + 1);
      if (is_new) vertices_ += "v " + decimal(world[0]) + " " + decimal(world[1]) + " " + decimal(world[2]) + "\n";
      ring.push_back({local[(dropped + 1) % 3], local[(dropped + 2) % 3], entry->second});
    }
    return ring;
  }

  static void save(const std::filesystem::path& path, const std::string& text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    if (!file.flush()) throw std::runtime_error(path.string() + ": cannot be written");
  }

  std::string materials_, vertices_, faces_, material_;
  Placement placement_;
  std::map<Ticks, std::size_t> numbers_;
  std::size_t objects_ = 0, triangles_ = 0;
};

/// What the main of each maker does: one argument, the folder; 2 for bad usage, 1 if the files cannot be written.
template <typename Make>
int run_maker(int argument_count, char** arguments, Make make) {
  if (argument_count != 2) {
    std::cerr << "usage: " << arguments[0] << " FOLDER\n";
    return 2;
  }
  try {
    make(std::filesystem::path(arguments[1]));
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return EXIT_FAILURE;
  }
}

}  // namespace example
