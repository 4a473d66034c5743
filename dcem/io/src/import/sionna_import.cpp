#include <algorithm>
#include <cmath>
#include <numbers>

#include "dcem/io/import.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/import/import_draft.hpp"
#include "dcem/io/src/import/mitsuba_scene.hpp"
#include "dcem/io/src/import/outlines.hpp"
#include "dcem/io/src/import/ply_reader.hpp"
#include "dcem/io/src/text/number_text.hpp"
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
    for (const std::string& name : draft_.scene.materials()) describe(name, scene);
    add_devices();
    draft_.scenario["frequency_hz"] = settings_.frequency_hz.value_or(sionna_frequency_hz);
    return write_import(std::move(draft_), folder_, settings_);
  }

 private:
  void add_shape(const MitsubaShape& shape, const MitsubaScene& scene) {
    if (shape.type != "ply" && shape.type != "rectangle" && shape.type != "cube") {
      ++draft_.report.skipped["shapes of type " + in_quotes(shape.type)];
      return;
    }
    if (!scene.materials.contains(shape.material)) {
      throw InputError(source_.string(), shape.line,
                       "shape " + in_quotes(shape.id) + ": material " + in_quotes(shape.material) +
                           " is nowhere defined; expected the id of a bsdf");
    }
    const PlyMesh mesh = shape.type == "ply" ? read_mesh(shape) : own_mesh(shape.type);
    if (mesh.faces_without_area > 0) {
      draft_.report.skipped["faces with fewer than three corners"] += mesh.faces_without_area;
    }
    const std::string material = material_name(shape.material);
    material_ids_.emplace(material, shape.material);
    draft_.scene.start_group(shape.id);
    for (const std::vector<std::size_t>& face : mesh.faces) {
      std::vector<Vec3> corners_m;
      for (const std::size_t corner : face) corners_m.push_back(placed(mesh.vertices_m[corner], shape));
      draft_.scene.face(material, corners_m);
      faces_m_.push_back(std::move(corners_m));
    }
    ++draft_.report.made["objects"];
  }

  Vec3 placed(const Vec3& corner_m, const MitsubaShape& shape) {
    const Vec3 there_m =
        shape.to_world == glm::dmat4(1.0) ? corner_m : Vec3(shape.to_world * glm::dvec4(corner_m, 1.0));
    low_m_ = glm::min(low_m_, there_m);
    high_m_ = glm::max(high_m_, there_m);
    return there_m;
  }

  PlyMesh read_mesh(const MitsubaShape& shape) const {
    const std::filesystem::path file = source_.parent_path() / shape.file;
    std::error_code ignored;
    if (shape.file.empty() || !std::filesystem::is_regular_file(file, ignored)) {
      throw InputError(
          source_.string(), shape.line,
          "shape " + in_quotes(shape.id) + ": file " + in_quotes(shape.file) + " is not there; expected a PLY mesh");
    }
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

  static std::string material_name(const std::string& id) {
    return obj_word(id.starts_with("mat-") && id.size() > 4 ? id.substr(4) : id);
  }

  /// The lines of a material in the MTL file.
  void describe(const std::string& name, const MitsubaScene& scene) {
    const std::string& id = material_ids_.at(name);
    const MitsubaMaterial& material = scene.materials.at(id);
    std::string text;
    if (material.type == "radio-material") {
      text = "em_model dielectric\n";
      put(material, "relative_permittivity", "eta_r", "em_relative_permittivity", text);
      put(material, "conductivity", "sigma", "em_conductivity_s_per_m", text);
    } else {
      const auto word = material.words.find("type");
      std::optional<std::string> itu = itu_name(id);
      if (material.type == "itu-radio-material" && word != material.words.end()) itu = word->second;
      if (!itu) {
        itu = "concrete";
        ++draft_.report.repaired["materials that say nothing of radio, taken for concrete"];
      }
      text = "em_model itu\nem_itu " + *itu + '\n';
    }
    put(material, "thickness", "", "em_thickness_m", text);
    put(material, "scattering_coefficient", "", "em_scattering", text);
    has_slabs_ = has_slabs_ || text.find("em_thickness_m") != std::string::npos;
    draft_.mtl[name] = text;
  }

  static void put(const MitsubaMaterial& material, const char* name, const char* other_name, const char* key,
                  std::string& text) {
    auto found = material.numbers.find(name);
    if (found == material.numbers.end()) found = material.numbers.find(other_name);
    if (found == material.numbers.end()) return;
    append_number(text += std::string(key) + ' ', found->second);
    text += '\n';
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
  std::map<std::string, std::string> material_ids_;  ///< by name in the OBJ file
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
