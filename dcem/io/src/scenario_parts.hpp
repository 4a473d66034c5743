#pragma once
/// The parts of a scenario file, each read by a function of its own. Private to dcem::io. All throw InputError.
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dcem/io/obj_reader.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/io/src/json_reader.hpp"
#include "dcem/io/src/material_keys.hpp"

namespace dcem::io {

inline constexpr double farthest_coordinate_m = 1e9;
inline constexpr NumberRange any_instant_s{-1e9, 1e9};

/// Runs `action`; what the engine finds wrong with the values is reported at `place`.
template <typename Action>
auto reported_at(const JsonValue& place, const Action& action) {
  try {
    return action();
  } catch (const std::invalid_argument& error) {
    place.fail(error.what());
  }
}

// scenario_settings.cpp

TimeSettings read_time(const JsonObject& scenario);
ItuSettings read_itu(const JsonObject& scenario);
SurfaceSettings read_surface_settings(const JsonObject& scene);
/// `command_line` holds what overrides the file: `--discovery`, `--rays`, …
PropagationSettings read_propagation(const JsonObject& scenario, const JsonObject& command_line);
OutputSettings read_output(const JsonObject& scenario, const JsonObject& command_line);
/// Refuses the blocks of a scenario that later versions bring.
void refuse_later_blocks(const JsonObject& scenario);

// scenario_motion.cpp

/// `position_m` with angles and velocity, or `waypoints`. A pose with a velocity holds at `reference_time_s`.
Motion read_motion(const JsonValue& value, double reference_time_s);

/// `velocity_mps`; zero where it is missing.
Vec3 read_velocity_mps(const JsonObject& object);

// scenario_devices.cpp

/// Adds the transmitters and receivers to the scene, and the receiver grids beside it.
void read_devices(const JsonObject& scenario, Scenario& result);

// scenario_bodies.cpp

/// Meshes and materials: reads the scenery and the objects and adds them to the scene with the materials they use.
class BodyLoader {
 public:
  BodyLoader(const JsonObject& scenario, std::filesystem::path folder, Scenario& result)
      : scenario_(scenario), folder_(std::move(folder)), result_(result) {}

  void load();

 private:
  struct Object {
    JsonValue value;
    std::string id;
    TriangleMesh mesh;
    Motion motion;
  };

  using FileKey = std::tuple<std::string, UpAxis, double>;  ///< name, up axis, unit

  const ObjFile& read_mesh(const JsonObject& owner);
  TriangleMesh read_object_mesh(const JsonObject& object);
  void read_objects();
  void collect_used_materials(const ObjFile& file, const std::string& name);
  void collect_mtl_materials(const ObjFile& file);
  void read_scenario_materials();
  MaterialKeys definition(const std::string& name) const;
  void add_materials();
  void check_frequency(const Material& material);

  const JsonObject& scenario_;
  std::filesystem::path folder_;
  Scenario& result_;
  std::map<FileKey, ObjFile> files_;
  std::vector<Object> objects_;
  std::map<std::string, std::string> used_materials_;               ///< FILE:LINE of the first use
  std::map<std::string, std::vector<MaterialKeys>> mtl_materials_;  ///< one entry per definition that differs
  std::map<std::string, MaterialKeys> scenario_materials_;
};

}  // namespace dcem::io
