#include "dcem/io/obj_reader.hpp"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <istream>
#include <limits>
#include <streambuf>
#include <string_view>
#include <utility>

#include "dcem/io/input_error.hpp"
#include "dcem/io/src/mesh/polygon_cutter.hpp"
#include "dcem/io/src/scenario/limits.hpp"
#include "dcem/io/src/scenario/material_keys.hpp"
#include "dcem/io/src/text/text_input.hpp"

// Single precision would round the coordinates of a city to centimetres.
static_assert(sizeof(tinyobj::real_t) == sizeof(double), "needs the double-precision build of tinyobjloader");

namespace dcem::io {

namespace {

constexpr const char* obj_expectation = "expected a Wavefront OBJ file";
constexpr std::size_t most_polygon_corners = 10'000;
/// Of a text, for each vertex: room that turns out too large takes no memory, and too little of it only time.
constexpr std::size_t usual_vertex_bytes = 32;

/// Material of faces that stand before the first `usemtl`.
constexpr const char* default_material_name = "default";

/// Statements that carry no surface, or only how it looks.
constexpr std::array<std::string_view, 22> harmless_keywords{
    "vn",  "vt",       "vw",       "g",      "o",      "s",          "mg",        "l",     "p",     "t",    "bevel",
    "lod", "c_interp", "d_interp", "usemap", "maplib", "shadow_obj", "trace_obj", "ctech", "stech", "call", "csh"};
/// Curved surfaces: legal, but they are not among the faces.
constexpr std::array<std::string_view, 15> curved_keywords{
    "vp", "deg", "bmat", "step", "cstype", "curv", "curv2", "surf", "parm", "trim", "hole", "scrv", "sp", "end", "con"};

/// What the check of an OBJ text finds out on its way.
struct CheckedObj {
  struct Library {
    std::size_t line;
    std::string names;  ///< the rest of the `mtllib` line
  };
  std::vector<Vec3> vertices_m;  ///< turned z up and in metres
  std::vector<Library> libraries;
  std::map<std::string, std::size_t> used_at;  ///< line of the first `usemtl` of each material
  std::size_t faces = 0;
  bool has_curved_surfaces = false;
};

/// Checks an OBJ text line by line. tinyobjloader reads garbage as 0, takes any index and knows no line numbers, so
/// everything that must be right is looked at here first. The vertices are read on the way: tinyobjloader adds a number
/// up digit by digit, which is off by a few units in the last place.
class ObjCheck {
 public:
  ObjCheck(std::string file, const ObjSettings& settings) : file_(std::move(file)), settings_(settings) {}

  CheckedObj check(std::string_view text) {
    LineReader lines(text);
    result_.vertices_m.reserve(text.size() / usual_vertex_bytes);
    while (lines.next()) {
      line_ = lines.number();
      check_line(lines.line());
    }
    result_.faces = faces_;
    if (faces_ == 0) throw InputError(file_, std::string("holds no face; ") + obj_expectation + " with 'f' lines");
    if (largest_index_ > static_cast<long long>(result_.vertices_m.size())) {
      line_ = largest_index_line_;
      fail_index(largest_index_);
    }
    return std::move(result_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(file_, line_, what); }

  [[noreturn]] void fail_index(long long index) const {
    fail("f: vertex " + std::to_string(index) + " does not exist; expected an index from 1 to " +
         std::to_string(result_.vertices_m.size()) + " or a negative one that counts back");
  }

  void check_line(std::string_view line) {
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (keyword.empty() || keyword.front() == '#') return;
    if (line.back() == '\\') fail("the line goes on behind '\\'; expected every statement on one line");
    if (keyword == "v") return check_vertex(rest);
    if (keyword == "f") return check_face(rest);
    if (keyword == "usemtl") {
      check_name(keyword, rest);
      result_.used_at.try_emplace(std::string(trimmed(rest)), line_);
      return;
    }
    if (keyword == "mtllib") {
      check_name(keyword, rest);
      result_.libraries.push_back({line_, std::string(trimmed(rest))});
      return;
    }
    if (std::find(harmless_keywords.begin(), harmless_keywords.end(), keyword) != harmless_keywords.end()) return;
    if (std::find(curved_keywords.begin(), curved_keywords.end(), keyword) == curved_keywords.end()) {
      fail("unknown statement " + in_quotes(keyword) + "; " + obj_expectation);
    }
    result_.has_curved_surfaces = true;
  }

  void check_vertex(std::string_view rest) {
    Vec3 point(0.0);
    int count = 0;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest), ++count) {
      const std::optional<double> number = parse_number(word);
      if (!number) fail("v: " + in_quotes(word) + " is no finite number; expected coordinates x y z");
      if (count < 3) point[count] = *number * settings_.unit_m;
    }
    if (count < 3) fail("v: " + std::to_string(count) + " numbers; expected at least 3 coordinates");
    if (!(glm::length(point) <= farthest_coordinate_m))
      fail("v: too far away; expected a point within 1e9 m of the origin");
    result_.vertices_m.push_back(settings_.up == UpAxis::z ? point : Vec3(point.x, -point.z, point.y));
  }

  void check_face(std::string_view rest) {
    std::size_t count = 0;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest), ++count) check_corner(word);
    if (count < 3) fail("f: " + std::to_string(count) + " corners; expected at least 3");
    if (count > most_polygon_corners) {
      fail("f: " + std::to_string(count) + " corners; expected at most " + std::to_string(most_polygon_corners));
    }
    if (faces_++ == 0 && result_.used_at.empty()) result_.used_at[default_material_name] = line_;
  }

  /// V, V/T, V//N or V/T/N.
  void check_corner(std::string_view word) {
    const std::size_t first = std::min(word.find('/'), word.size());
    const std::string_view attributes = word.substr(first);
    const std::optional<long long> index = parse_integer(word.substr(0, first));
    if (!index || !is_attribute_list(attributes))
      fail("f: " + in_quotes(word) + " is no corner; expected V, V/T, V//N or V/T/N");
    const auto known = static_cast<long long>(result_.vertices_m.size());
    if (*index == 0 || *index < -known || *index > std::numeric_limits<int>::max()) fail_index(*index);
    if (*index > largest_index_) {
      largest_index_ = *index;
      largest_index_line_ = line_;
    }
  }

  static bool is_attribute_list(std::string_view text) {
    if (text.empty()) return true;
    const std::size_t second = text.find('/', 1);
    const auto is_index = [](std::string_view part) { return parse_integer(part).has_value(); };
    if (second == std::string_view::npos) return is_index(text.substr(1));
    return (second == 1 || is_index(text.substr(1, second - 1))) && is_index(text.substr(second + 1));
  }

  void check_name(std::string_view keyword, std::string_view rest) const {
    const std::string_view name = trimmed(rest);
    if (name.empty()) fail(std::string(keyword) + ": no name; expected one");
    if (!is_printable(name))
      fail(std::string(keyword) + ": " + in_quotes(name) + " holds control characters; expected a name");
  }

  std::string file_;
  ObjSettings settings_;
  std::size_t line_ = 0, faces_ = 0;
  long long largest_index_ = 0;
  std::size_t largest_index_line_ = 0;
  CheckedObj result_;
};

/// A text as tinyobjloader wants it, where it lies: texts of large cities are large.
class TextBuffer : public std::streambuf {
 public:
  explicit TextBuffer(const std::string& text) {
    char* first = const_cast<char*>(text.data());  // a get area is never written to
    setg(first, first, first + text.size());
  }
};

/// Receives what tinyobjloader reads from a checked text and makes triangles of it.
class MeshBuilder {
 public:
  MeshBuilder(std::vector<Vec3> vertices_m, std::size_t faces) {
    mesh_.vertices_m = std::move(vertices_m);
    mesh_.triangles.reserve(faces);
  }

  TriangleMesh build(const std::string& text) {
    tinyobj::callback_t callback;
    callback.vertex_cb = [](void* self, double, double, double, double) { ++cast(self).vertices_so_far_; };
    callback.usemtl_cb = [](void* self, const char* name, int) { cast(self).use_material(name); };
    callback.index_cb = [](void* self, tinyobj::index_t* corners, int count) {
      cast(self).add_polygon({corners, static_cast<std::size_t>(count)});
    };
    TextBuffer buffer(text);
    std::istream stream(&buffer);
    tinyobj::LoadObjWithCallback(stream, callback, this);
    return std::move(mesh_);
  }

  std::size_t polygons_crossing_themselves() const { return polygons_crossing_themselves_; }

 private:
  static MeshBuilder& cast(void* self) { return *static_cast<MeshBuilder*>(self); }

  void use_material(std::string_view name) {
    const std::string key(trimmed(name));
    const auto [entry, is_new] =
        material_numbers_.try_emplace(key, static_cast<std::uint32_t>(mesh_.material_names.size()));
    if (is_new) mesh_.material_names.push_back(key);
    material_ = entry->second;
  }

  void add_polygon(std::span<const tinyobj::index_t> corners) {
    if (mesh_.material_names.empty()) use_material(default_material_name);
    corners_.clear();
    for (const tinyobj::index_t& corner : corners) {
      const int index = corner.vertex_index > 0 ? corner.vertex_index - 1 : vertices_so_far_ + corner.vertex_index;
      corners_.push_back(static_cast<std::uint32_t>(index));
    }
    if (corners_.size() == 3) return add_triangle(0, 1, 2);
    points_m_.clear();
    for (const std::uint32_t corner : corners_) points_m_.push_back(mesh_.vertices_m[corner]);
    for (const auto& [a, b, c] : cutter_.cut(points_m_)) add_triangle(a, b, c);
    if (cutter_.crosses_itself()) ++polygons_crossing_themselves_;
  }

  void add_triangle(std::size_t a, std::size_t b, std::size_t c) {
    mesh_.triangles.push_back({{corners_[a], corners_[b], corners_[c]}, material_});
  }

  TriangleMesh mesh_;
  std::map<std::string, std::uint32_t> material_numbers_;
  std::uint32_t material_ = 0;
  int vertices_so_far_ = 0;
  std::vector<std::uint32_t> corners_;
  std::vector<Vec3> points_m_;
  PolygonCutter cutter_;
  std::size_t polygons_crossing_themselves_ = 0;
};

/// Reads the `newmtl` blocks and their `em_*` keys. tinyobjloader's reader gives no line numbers, keeps the first of
/// two equal keys and reads a damaged number as 0.
class MtlReader {
 public:
  MtlReader(std::string file, std::map<std::string, MtlMaterial>& materials)
      : file_(std::move(file)), materials_(materials) {}

  void read(std::string_view text) {
    LineReader lines(text);
    while (lines.next()) {
      std::string_view rest = lines.line();
      const std::string_view keyword = take_word(rest);
      line_ = lines.number();
      if (keyword == "newmtl") start_block(trimmed(rest));
      if (keyword.starts_with("em_")) add_key(std::string(keyword), rest);
    }
    finish_block();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw InputError(file_, line_, what); }

  void start_block(std::string_view name) {
    finish_block();
    if (name.empty() || !is_printable(name)) fail("newmtl: found " + in_quotes(name) + "; expected a name");
    name_ = name;
    block_ = {file_, line_, {}};
  }

  void add_key(const std::string& keyword, std::string_view rest) {
    if (!is_printable(keyword)) fail(in_quotes(keyword) + " holds control characters; expected a key");
    if (block_.line == 0) fail(keyword + ": stands before the first newmtl; expected it inside a material");
    const std::string_view value = trimmed(rest.substr(0, rest.find('#')));
    if (value.empty()) fail(keyword + ": no value; expected one");
    const auto [entry, is_new] = block_.em_keys.try_emplace(keyword, MtlMaterial::Entry{std::string(value), line_});
    if (!is_new) fail(keyword + ": stands twice in material " + in_quotes(name_) + "; expected it once");
  }

  void finish_block() {
    if (block_.line == 0) return;
    const MaterialKeys keys = keys_from_mtl(block_);  // checks the keys of materials that nothing uses as well
    make_material(name_, keys);
    const auto [entry, is_new] = materials_.try_emplace(name_, block_);
    if (!is_new && !same_definition(keys_from_mtl(entry->second), keys)) {
      throw InputError(file_, block_.line,
                       "material " + in_quotes(name_) + " differs from " + entry->second.file + ":" +
                           std::to_string(entry->second.line) + "; expected one definition");
    }
    block_ = {};
  }

  std::string file_;
  std::map<std::string, MtlMaterial>& materials_;
  std::size_t line_ = 0;
  std::string name_;
  MtlMaterial block_;  ///< line 0: none
};

/// The files that an `mtllib` line names: one whose name holds blanks, or several.
std::vector<std::filesystem::path> library_files(const std::filesystem::path& folder, const std::string& names) {
  if (!trouble_of(folder / names)) return {folder / names};
  std::vector<std::filesystem::path> files;
  std::string_view rest = names;
  for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) files.push_back(folder / word);
  return files;
}

void read_libraries(const std::filesystem::path& obj_file, const CheckedObj& checked, ObjFile& result) {
  for (const CheckedObj::Library& library : checked.libraries) {
    for (const std::filesystem::path& file : library_files(obj_file.parent_path(), library.names)) {
      if (const auto trouble = trouble_of_named(file)) {
        throw InputError(obj_file.string(), library.line,
                         "mtllib: " + in_quotes(file.filename().string()) + " " + *trouble +
                             "; expected an MTL file beside the OBJ");
      }
      MtlReader(file.string(), result.materials).read(read_text_file(file, "expected an MTL file"));
    }
  }
}

}  // namespace

ObjFile read_obj(const std::filesystem::path& file, const ObjSettings& settings) {
  const std::string text = read_text_file(file, obj_expectation);
  CheckedObj checked = ObjCheck(file.string(), settings).check(text);
  ObjFile result;
  read_libraries(file, checked, result);
  result.used_at = std::move(checked.used_at);
  MeshBuilder builder(std::move(checked.vertices_m), checked.faces);
  result.mesh = builder.build(text);
  if (checked.has_curved_surfaces) {
    result.warnings.push_back(file.string() + ": free-form curves and surfaces are left out; only faces are read");
  }
  if (builder.polygons_crossing_themselves() > 0) {
    result.warnings.push_back(file.string() + ": " + std::to_string(builder.polygons_crossing_themselves()) +
                              " polygons cross themselves or have no area; they were cut as well as could be");
  }
  return result;
}

}  // namespace dcem::io
