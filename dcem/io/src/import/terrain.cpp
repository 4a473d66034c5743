#include "dcem/io/src/import/terrain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "dcem/io/input_error.hpp"
#include "dcem/io/src/import/plan_corners.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

/// The header's keys in any order and case, then the northernmost row first.
/// Source: Esri, "Esri ASCII raster format", ArcGIS documentation; `dx` and `dy` are GDAL's.
class GridReader {
 public:
  explicit GridReader(const std::filesystem::path& file)
      : name_(file.string()), text_(read_text_file(file, "expected an ASCII grid of ESRI")), lines_(text_) {}

  Terrain read() {
    read_header();
    Terrain terrain;
    place(terrain);
    terrain.heights_m.assign(terrain.columns * terrain.rows, 0.0);
    for (std::size_t row = terrain.rows; row-- > 0;) {
      for (std::size_t column = 0; column < terrain.columns; ++column) {
        terrain.heights_m[row * terrain.columns + column] = next_height(terrain);
      }
    }
    if (!next_word().empty()) fail("more heights than columns times rows; expected the end of the grid");
    count_from_lowest(terrain);
    return terrain;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(name_, std::max<std::size_t>(1, lines_.number()), what);
  }

  std::string_view next_word() {
    while (true) {
      const std::string_view word = take_word(rest_);
      if (!word.empty()) return word;
      if (!lines_.next()) return {};
      rest_ = lines_.line();
    }
  }

  double number(std::string_view word, const std::string& what) const {
    const std::optional<double> value = parse_number(word);
    if (!value || std::abs(*value) > 1e9) fail(what + ": found " + in_quotes(word) + "; expected a number within 1e9");
    return *value;
  }

  void read_header() {
    while (true) {
      std::string key(next_word());
      if (key.empty()) fail("no heights; expected ncols, nrows, xllcorner, yllcorner, cellsize and a grid");
      if (parse_number(key)) {
        first_ = key;
        return;
      }
      std::transform(key.begin(), key.end(), key.begin(), [](unsigned char letter) { return std::tolower(letter); });
      header_[printable(key)] = number(next_word(), printable(key));
    }
  }

  double demand(const char* key, const char* other = nullptr) const {
    auto found = header_.find(key);
    if (found == header_.end() && other != nullptr) found = header_.find(other);
    if (found == header_.end()) fail(std::string("no ") + key + "; expected it in the header");
    return found->second;
  }

  std::size_t count(const char* key) const {
    const double value = demand(key);
    if (value < 2.0 || value != std::floor(value) || value > static_cast<double>(text_.size())) {
      fail(std::string(key) + ": found " + number_text(value) +
           "; expected a whole number from 2, no more than the file holds");
    }
    return static_cast<std::size_t>(value);
  }

  void place(Terrain& terrain) const {
    terrain.columns = count("ncols");
    terrain.rows = count("nrows");
    if (terrain.columns > text_.size() / terrain.rows) {
      fail("more columns and rows than the file holds; expected as many heights as columns times rows");
    }
    terrain.cell_m = {demand("cellsize", "dx"), demand("cellsize", "dy")};
    if (!(terrain.cell_m.x > 0.0) || !(terrain.cell_m.y > 0.0)) fail("a cell without size; expected cellsize above 0");
    terrain.low_m = {demand("xllcenter", "xllcorner"), demand("yllcenter", "yllcorner")};
    if (!header_.contains("xllcenter")) terrain.low_m.x += 0.5 * terrain.cell_m.x;
    if (!header_.contains("yllcenter")) terrain.low_m.y += 0.5 * terrain.cell_m.y;
  }

  double next_height(Terrain& terrain) {
    const std::string word = first_.empty() ? std::string(next_word()) : std::exchange(first_, {});
    if (word.empty()) fail("the grid breaks off; expected as many heights as columns times rows");
    const double height_m = number(word, "height");
    const auto absent = header_.find("nodata_value");
    if (height_m != (absent == header_.end() ? -9999.0 : absent->second)) return height_m;
    ++terrain.without_value;
    return std::numeric_limits<double>::infinity();
  }

  void count_from_lowest(Terrain& terrain) const {
    terrain.lowest_m = *std::min_element(terrain.heights_m.begin(), terrain.heights_m.end());
    if (!std::isfinite(terrain.lowest_m)) fail("no cell has a height; expected at least one");
    for (double& height_m : terrain.heights_m) {
      height_m = std::isfinite(height_m) ? std::round((height_m - terrain.lowest_m) * 1000.0) / 1000.0 : 0.0;
    }
  }

  std::string name_, text_;
  LineReader lines_;
  std::string_view rest_;
  std::string first_;  ///< the height with which the header ended
  std::map<std::string, double> header_;
};

/// The blocks that parts belong to: those with a common edge are of one.
std::vector<std::size_t> blocks_of(const std::vector<TownPart>& parts) {
  std::vector<std::size_t> parent(parts.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t part) {
    while (parent[part] != part) part = parent[part] = parent[parent[part]];
    return part;
  };
  std::map<std::pair<GridCorner, GridCorner>, std::size_t> seen;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    for (const Area& area : parts[part].areas) {
      for_each_edge(area, [&](const Vec2& from, const Vec2& to) {
        seen.emplace(std::pair{grid_corner(from), grid_corner(to)}, part);
        const auto other = seen.find({grid_corner(to), grid_corner(from)});
        if (other != seen.end()) parent[root(part)] = root(other->second);
      });
    }
  }
  for (std::size_t part = 0; part < parts.size(); ++part) parent[part] = root(part);
  return parent;
}

}  // namespace

double Terrain::height_m(const Vec2& point_m) const {
  const auto clamped = [](double value, std::size_t count) {
    return std::clamp(value, 0.0, static_cast<double>(count - 1));
  };
  const double x = clamped((point_m.x - low_m.x) / cell_m.x, columns);
  const double y = clamped((point_m.y - low_m.y) / cell_m.y, rows);
  const std::size_t column = std::min(static_cast<std::size_t>(x), columns - 2);
  const std::size_t row = std::min(static_cast<std::size_t>(y), rows - 2);
  const double u = x - static_cast<double>(column), v = y - static_cast<double>(row);
  const double* const here = &heights_m[row * columns + column];
  return (1.0 - v) * ((1.0 - u) * here[0] + u * here[1]) + v * ((1.0 - u) * here[columns] + u * here[columns + 1]);
}

Terrain read_terrain(const std::filesystem::path& file) {
  return GridReader(file).read();
}

void settle(std::vector<TownPart>& parts, const Terrain& terrain) {
  constexpr double buried_m = 0.5;  // between its corners the ground may lie lower
  const std::vector<std::size_t> blocks = blocks_of(parts);
  std::vector<double> lowest_m(parts.size(), std::numeric_limits<double>::infinity());
  for (std::size_t part = 0; part < parts.size(); ++part) {
    double& its_m = lowest_m[blocks[part]];
    for (const Area& area : parts[part].areas) {
      for (const Vec2& corner : area.outer) its_m = std::min(its_m, terrain.height_m(corner));
    }
  }
  const auto rounded_m = [](double value_m) { return std::round(value_m * 1000.0) / 1000.0; };
  for (std::size_t part = 0; part < parts.size(); ++part) {
    const double ground_m = lowest_m[blocks[part]];
    parts[part].top_m = rounded_m(parts[part].top_m + ground_m);
    parts[part].foot_m = rounded_m(ground_m - buried_m);
  }
}

void add_terrain(const Terrain& terrain, const Vec2& low_m, const Vec2& high_m, ObjDraft& obj) {
  obj.start_group("ground");
  const auto corner = [&](std::size_t column, std::size_t row) {
    const Vec2 flat_m = terrain.low_m + terrain.cell_m * Vec2(static_cast<double>(column), static_cast<double>(row));
    return Vec3(flat_m.x, flat_m.y, terrain.heights_m[row * terrain.columns + column]);
  };
  for (std::size_t row = 0; row + 1 < terrain.rows; ++row) {
    for (std::size_t column = 0; column + 1 < terrain.columns; ++column) {
      const Vec3 a = corner(column, row), c = corner(column + 1, row + 1);
      if (c.x < low_m.x || c.y < low_m.y || a.x > high_m.x || a.y > high_m.y) continue;
      obj.face("ground", {a, corner(column + 1, row), c});
      obj.face("ground", {a, c, corner(column, row + 1)});
    }
  }
}

}  // namespace dcem::io
