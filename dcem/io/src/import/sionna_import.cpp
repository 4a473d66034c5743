#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dcem/io/import.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/import/import_draft.hpp"
#include "dcem/io/src/import/mitsuba_scene.hpp"
#include "dcem/io/src/import/outlines.hpp"
#include "dcem/io/src/import/ply_reader.hpp"
#include "dcem/io/src/scenario/limits.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

constexpr double sionna_frequency_hz = 3.5e9;  // Sionna RT's own default

/// "mat-itu_concrete", "itu-concrete" → "concrete"; nothing where the name says no ITU material.
std::optional<std::string> itu_name(const std::string& id) {
  std::string_view rest = id;
  if (rest.starts_with("mat-")) rest.remove_prefix(4);
  if (!rest.starts_with("itu_") && !rest.starts_with("itu-")) return std::nullopt;
  std::string name(rest.substr(4));
  std::replace(name.begin(), name.end(), '-', '_');
  return name.substr(0, name.find('.'));  // Blender numbers copies: "itu_concrete.001"
}

class SionnaImport {
 public:
  SionnaImport(const std::filesystem::path& source, const std::filesystem::path& folder, const ImportSettings& settings)
      : source_(source), folder_(folder), settings_(settings) {
    draft_.importer = "sionna";
    draft_.sources.push_back(source);
  }

  ImportReport run() {
    const MitsubaScene scene = read_mitsuba_scene(source_);
    draft_.report.read["shapes"] = scene.shapes.size();
    draft_.report.read["materials"] = scene.materials.size();
    for (const MitsubaShape& shape : scene.shapes) add_shape(shape, scene);
    if (draft_.scene.empty()) throw InputError(source_.string(), "holds no surface; expected shapes of type ply");
    for (const auto& [id, name] : material_names_) describe(id, name, scene.materials.at(id));
    add_devices();
    draft_.frequency_hz = sionna_frequency_hz;
    return write_import(std::move(draft_), folder_, settings_);
  }

 private:
  void add_shape(const MitsubaShape& shape, const MitsubaScene& scene) {
    if (shape.type != "ply" && shape.type != "rectangle" && shape.type != "cube") {
      ++draft_.report.skipped["shapes of type " + in_quotes(shape.type)];
      return;
    }
    if (!scene.materials.contains(shape.material)) {
      fail(shape, "material " + in_quotes(shape.material) + " is nowhere defined; expected the id of a bsdf");
    }
    const PlyMesh mesh = shape.type == "ply" ? read_mesh(shape) : own_mesh(shape.type);
    if (mesh.faces_without_area > 0) {
      draft_.report.skipped["faces with fewer than three corners"] += mesh.faces_without_area;
    }
    const std::string material = material_name(shape.material);
    draft_.scene.start_group(shape.id);
    check_size(mesh, shape);
    for (const std::vector<std::size_t>& face : mesh.faces) {
      std::vector<Vec3> corners_m;
      for (const std::size_t corner : face) corners_m.push_back(placed(mesh.vertices_m[corner], shape));
      for (const Vec3& corner_m : corners_m) widen(corner_m);
      draft_.scene.face(material, corners_m);
      faces_m_.push_back(std::move(corners_m));
    }
    ++draft_.report.made["objects"];
  }

  [[noreturn]] void fail(const MitsubaShape& shape, const std::string& what) const {
    throw InputError(source_.string(), shape.line, "shape " + in_quotes(shape.id) + ": " + what);
  }

  /// A shape that its transform makes smaller than what is welded together is a slip of the transform.
  void check_size(const PlyMesh& mesh, const MitsubaShape& shape) const {
    constexpr double smallest_m = 1e-4;
    Vec3 low_m(std::numeric_limits<double>::infinity()), high_m(-low_m);
    for (const Vec3& corner_m : mesh.vertices_m) {
      low_m = glm::min(low_m, placed(corner_m, shape));
      high_m = glm::max(high_m, placed(corner_m, shape));
    }
    if (mesh.vertices_m.empty() || glm::distance(low_m, high_m) >= smallest_m) return;
    fail(shape, "is " + number_text(glm::distance(low_m, high_m)) +
                    " m large; expected at least 0.0001 m, by its mesh "
                    "and its to_world");
  }

  Vec3 placed(const Vec3& corner_m, const MitsubaShape& shape) const {
    const Vec3 there_m =
        shape.to_world == glm::dmat4(1.0) ? corner_m : Vec3(shape.to_world * glm::dvec4(corner_m, 1.0));
    if (glm::length(there_m) <= farthest_coordinate_m) return there_m;
    fail(shape, "a corner too far away; expected points within 1e9 m of the origin, by its mesh and its to_world");
  }

  PlyMesh read_mesh(const MitsubaShape& shape) const {
    const std::filesystem::path file = source_.parent_path() / shape.file;
    const std::optional<std::string> trouble = shape.file.empty() ? "is not there" : trouble_of_named(file);
    if (trouble) fail(shape, "file " + in_quotes(shape.file) + " " + *trouble + "; expected a PLY mesh");
    return read_ply(file);
  }

  /// Mitsuba's own shapes reach from -1 to 1.
  static PlyMesh own_mesh(const std::string& type) {
    PlyMesh mesh;
    if (type == "rectangle") {
      mesh.vertices_m = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
      mesh.faces = {{0, 1, 2, 3}};
      return mesh;
    }
    mesh.vertices_m = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                       {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
    mesh.faces = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    return mesh;
  }

  /// The name of a material in the OBJ file. Ids that would have the same name there keep apart.
  std::string material_name(const std::string& id) {
    const auto known = material_names_.find(id);
    if (known != material_names_.end()) return known->second;
    std::string name = obj_word(id.starts_with("mat-") && id.size() > 4 ? id.substr(4) : id);
    const auto is_taken = [&](const auto& other) { return other.second == name; };
    while (std::any_of(material_names_.begin(), material_names_.end(), is_taken)) name += '_';
    return material_names_.emplace(id, name).first->second;
  }

  std::string place(std::size_t line, const std::string& id) const {
    return source_.string() + ":" + std::to_string(line) + ": bsdf " + in_quotes(id);
  }

  void describe(const std::string& id, const std::string& name, const MitsubaMaterial& source) {
    MaterialDraft material(name, place(source.line, id));
    if (source.type == "radio-material") {
      material.add("model", "dielectric");
      put(source, "relative_permittivity", "eta_r", "relative_permittivity", id, material);
      put(source, "conductivity", "sigma", "conductivity_s_per_m", id, material);
    } else {
      material.add("model", "itu");
      put_itu(source, id, material);
    }
    put(source, "thickness", "", "thickness_m", id, material);
    put(source, "scattering_coefficient", "", "scattering", id, material);
    has_slabs_ = has_slabs_ || material.has("thickness_m");
    draft_.materials.emplace(name, std::move(material));
  }

  void put_itu(const MitsubaMaterial& source, const std::string& id, MaterialDraft& material) {
    const auto word = source.words.find("type");
    if (source.type == "itu-radio-material" && word != source.words.end()) {
      return material.add("itu", word->second.value, place(word->second.line, id), "type");
    }
    std::optional<std::string> itu = itu_name(id);
    if (!itu) ++draft_.report.repaired["materials that say nothing of radio, taken for concrete"];
    material.add("itu", itu.value_or("concrete"));
  }

  void put(const MitsubaMaterial& source, const char* name, const char* other_name, const char* key,
           const std::string& id, MaterialDraft& material) const {
    auto found = source.numbers.find(name);
    if (found == source.numbers.end()) found = source.numbers.find(other_name);
    if (found == source.numbers.end()) return;
    material.add(key, number_text(found->second.value), place(found->second.line, id), found->first);
  }

  void widen(const Vec3& corner_m) {
    low_m_ = glm::min(low_m_, corner_m);
    high_m_ = glm::max(high_m_, corner_m);
  }

  /// Whether a face is above a point.
  bool is_covered(const Vec3& point_m) const {
    return std::any_of(faces_m_.begin(), faces_m_.end(), [&](const std::vector<Vec3>& face_m) {
      Area area;
      double lowest_m = high_m_.z;
      for (const Vec3& corner_m : face_m) {
        area.outer.emplace_back(corner_m.x, corner_m.y);
        lowest_m = std::min(lowest_m, corner_m.z);
      }
      return lowest_m > point_m.z && holds_point(area, Vec2(point_m));
    });
  }

  /// A mast above everything, in a room below its ceiling, and points around it near the ground.
  void add_devices() {
    const Vec3 middle_m = 0.5 * (low_m_ + high_m_);
    const double radius_m = 0.2 * std::min(high_m_.x - low_m_.x, high_m_.y - low_m_.y);
    nlohmann::ordered_json points = nlohmann::ordered_json::array();
    bool is_room = true;
    for (int point = 0; point < 8; ++point) {
      const double angle_rad = (point + 0.5) * std::numbers::pi / 4.0;
      const Vec3 point_m(middle_m.x + radius_m * std::cos(angle_rad), middle_m.y + radius_m * std::sin(angle_rad),
                         low_m_.z + 1.5);
      points.push_back({rounded(point_m.x), rounded(point_m.y), rounded(point_m.z)});
      is_room = is_room && is_covered(point_m);
    }
    const double mast_m = is_room ? low_m_.z + 0.8 * (high_m_.z - low_m_.z) : high_m_.z + 5.0;
    draft_.scenario["propagation"] = town_propagation_json();
    if (has_slabs_) draft_.scenario["propagation"]["max_transmissions"] = 1;
    draft_.scenario["transmitters"] =
        nlohmann::ordered_json::array({{{"id", "mast"},
                                        {"position_m", {rounded(middle_m.x), rounded(middle_m.y), rounded(mast_m)}},
                                        {"power_dbm", 30}}});
    draft_.scenario["receivers"] = nlohmann::ordered_json::array({{{"id", "point"}, {"positions_m", points}}});
    draft_.report.notes.push_back(
        "One mast and eight points were chosen for a start: edit transmitters and receivers.");
  }

  static double rounded(double value_m) { return std::round(value_m * 1000.0) / 1000.0; }

  std::filesystem::path source_, folder_;
  const ImportSettings& settings_;
  ImportDraft draft_;
  std::map<std::string, std::string> material_names_;  ///< in the OBJ file, by id
  std::vector<std::vector<Vec3>> faces_m_;
  Vec3 low_m_{1e9}, high_m_{-1e9};
  bool has_slabs_ = false;
};

}  // namespace

ImportReport import_sionna(const std::filesystem::path& scene, const std::filesystem::path& folder,
                           const ImportSettings& settings) {
  check_settings(settings, scene);
  if (!settings.terrain.empty()) {
    throw InputError(settings.terrain.string(), "has no effect on a scene of Sionna; expected no terrain");
  }
  return SionnaImport(scene, folder, settings).run();
}

}  // namespace dcem::io
