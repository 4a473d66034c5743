#pragma once
/// The parts of a scenario file, each read by a function of its own. Private to dcem::io. All throw InputError.
#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "dcem/io/obj_reader.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/io/src/scenario/json_reader.hpp"
#include "dcem/io/src/scenario/limits.hpp"
#include "dcem/io/src/scenario/material_keys.hpp"
#include "dcem/io/src/traffic/poses_csv.hpp"

namespace dcem::io {

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
WideTreeSettings read_tree(const JsonObject& scenario);
SurfaceSettings read_surface_settings(const JsonObject& scene);
/// `command_line` holds what overrides the file: `--discovery`, `--rays`, …
PropagationSettings read_propagation(const JsonObject& scenario, const JsonObject& command_line);
OutputSettings read_output(const JsonObject& scenario, const JsonObject& command_line);
/// The keys of `output` for files that other programs read.
ExchangeSettings read_exchange(const JsonObject& object, bool has_place);
/// Refuses what needs a place on the Earth.
[[noreturn]] void require_place(const JsonValue& place);
/// The block `geo`, if there is one.
std::optional<GeoAnchor> read_geo(const JsonObject& scenario);
/// The block `noise`, if there is one.
std::optional<NoiseSettings> read_noise(const JsonObject& scenario);

// scenario_motion.cpp

/// Reads the motions of a scenario; a file of poses is read once, however many objects and devices it moves.
class MotionReader {
 public:
  /// Files are relative to `folder`. A pose with a velocity holds at `reference_time_s`.
  MotionReader(std::filesystem::path folder, double reference_time_s)
      : folder_(std::move(folder)), reference_time_s_(reference_time_s) {}

  /// `position_m` with angles and velocity, or `waypoints`, or `poses_csv` with rows of this id.
  Motion read(const JsonValue& value, const std::string& id);
  /// When all has been read: every row of every file must have moved something.
  void check_all_taken() const;

 private:
  WaypointMotion read_poses(const JsonValue& name, const std::string& id);

  std::filesystem::path folder_;
  double reference_time_s_;
  std::map<std::string, PosesCsv> files_;
};

/// `velocity_mps`; zero where it is missing.
Vec3 read_velocity_mps(const JsonObject& object);

/// The file that a value names, relative to `folder`. `expectation` as in "expected an OBJ file".
std::filesystem::path existing_file(const JsonValue& name, const std::filesystem::path& folder,
                                    const std::string& expectation);

// scenario_mobility.cpp

/// Reads the block `mobility`, if there is one, and the whole trace once: who drives when, and how many at a time. The
/// instants that `time` leaves open are those of the trace.
void read_mobility(const JsonObject& scenario, const std::filesystem::path& folder, Scenario& result);

// scenario_antenna.cpp

/// Reads the antennas of a scenario; a file of a pattern is read once, and its table shared by all antennas that name
/// it.
class AntennaReader {
 public:
  /// Files are relative to `folder`.
  explicit AntennaReader(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The block `antenna` of a device; without one an isotropic antenna.
  Antenna read(const JsonObject& owner);

 private:
  AntennaPattern read_pattern(const JsonValue& value);
  std::shared_ptr<const PatternTable> read_table(const JsonObject& file);

  std::filesystem::path folder_;
  std::map<std::pair<std::string, std::string>, std::shared_ptr<const PatternTable>> tables_;  ///< by format and name
};

// scenario_devices.cpp

/// Adds the transmitters and receivers to the scene, and the receiver grids beside it. Files are relative to `folder`.
void read_devices(const JsonObject& scenario, const std::filesystem::path& folder, MotionReader& motions,
                  AntennaReader& antennas, Scenario& result);

// scenario_links.cpp

/// Adds the devices of `mobility.devices`, if there is such a block, to the scene.
void read_vehicle_devices(const JsonObject& scenario, AntennaReader& antennas, Scenario& result);
/// The key `links`, between devices that the scene has.
LinkSettings read_links(const JsonObject& scenario, const Scene& scene);

// scenario_bodies.cpp

/// Meshes and materials: reads the scenery and the objects and adds them to the scene with the materials they use, and
/// the body pools of the traffic that `read_mobility` found.
class BodyLoader {
 public:
  BodyLoader(const JsonObject& scenario, std::filesystem::path folder, MotionReader& motions, Scenario& result)
      : scenario_(scenario), folder_(std::move(folder)), motions_(motions), result_(result) {}

  void load();

 private:
  struct Object {
    JsonValue value;
    std::string id;
    TriangleMesh mesh;
    Motion motion;
  };

  using FileKey = std::tuple<std::string, UpAxis, double>;  ///< name, up axis, unit

  const ObjFile& read_file(const JsonObject& owner);
  const ObjFile& read_mesh(const JsonObject& owner);  ///< whose materials are used
  TriangleMesh read_object_mesh(const JsonObject& object);
  void read_objects();
  void check_object_id(const JsonValue& id) const;
  void add_traffic();
  void collect_used_materials(const ObjFile& file, const std::string& name);
  void collect_mtl_materials(const ObjFile& file);
  void read_scenario_materials();
  MaterialKeys definition(const std::string& name) const;
  void add_materials();
  void check_frequency(const Material& material);
  void warn(const JsonValue& place, const std::string& subject, const std::vector<std::string>& doubts);

  const JsonObject& scenario_;
  std::filesystem::path folder_;
  MotionReader& motions_;
  Scenario& result_;
  std::map<FileKey, ObjFile> files_;
  std::vector<Object> objects_;
  std::vector<JsonValue> foliage_objects_;                          ///< the keys `foliage` that are true
  std::map<std::string, std::string> used_materials_;               ///< FILE:LINE of the first use
  std::map<std::string, std::vector<MaterialKeys>> mtl_materials_;  ///< one entry per definition that differs
  std::map<std::string, MaterialKeys> scenario_materials_;
};

}  // namespace dcem::io
