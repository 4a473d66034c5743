#pragma once
/// Scenes for tests of physical laws. A scene is a list of flat patches; on its way to the engine it is written as OBJ
/// and MTL and read back, so every law holds for what stands in files, not only for what stands in memory.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/core/units.hpp"
#include "dcem/io/obj_reader.hpp"
#include "dcem/paths/path_id.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/io/temporary_folder.hpp"

namespace dcem::test {

/// A flat convex polygon of one material; the corners go around it, either way.
struct Patch {
  std::vector<Vec3> corners_m;
  std::string material;
};

using Patches = std::vector<Patch>;

/// An object of its own with its motion; patches in local coordinates.
struct MovingPatches {
  std::string id;
  Patches patches;
  Motion motion;
};

/// What the MTL file of every law scene holds: material name and its `em_*` lines.
inline const std::map<std::string, std::string>& law_materials() {
  static const std::map<std::string, std::string> materials{
      {"pec", "em_model pec\n"},
      {"opaque", "em_model constant\nem_reflection 0.8\n"},
      {"alpha", "em_model constant\nem_reflection 0.9\n"},
      {"wall", "em_model constant\nem_reflection 0.7\nem_penetration_loss_db 20\n"},
      {"glass", "em_model constant\nem_reflection 0.74\nem_penetration_loss_db 5\n"},
      {"lossless", "em_model dielectric\nem_relative_permittivity 3.7\nem_thickness_m 0.0123\n"},
      {"lossy",
       "em_model dielectric\nem_relative_permittivity 5.1\nem_conductivity_s_per_m 0.2\nem_thickness_m 0.02\n"},
      {"half_space", "em_model dielectric\nem_relative_permittivity 4.4\nem_conductivity_s_per_m 0.05\n"},
      {"itu_concrete", ""}};
  return materials;
}

/// True for the materials above through which a leg may pass.
inline bool transmissive(const std::string& material) {
  return material == "wall" || material == "glass" || material == "lossless" || material == "lossy";
}

inline void write_law_materials(const std::filesystem::path& file) {
  std::ofstream stream(file);
  for (const auto& [name, keys] : law_materials()) stream << "newmtl " << name << "\n" << keys;
}

/// Writes the patches as polygons with their own vertices: 17 digits bring every double back as it was.
inline void write_patches(const std::filesystem::path& file, const Patches& patches) {
  std::ofstream stream(file);
  stream << std::setprecision(17) << "mtllib laws.mtl\n";
  std::size_t vertex = 0;
  for (const Patch& patch : patches) {
    for (const Vec3& corner : patch.corners_m) stream << "v " << corner.x << ' ' << corner.y << ' ' << corner.z << "\n";
    stream << "usemtl " << patch.material << "\nf";
    for (std::size_t corner = 0; corner < patch.corners_m.size(); ++corner) stream << ' ' << ++vertex;
    stream << "\n";
  }
}

/// Adds what a file holds to a scene; `add_mesh` says what its mesh is.
template <typename AddMesh>
void add_obj_file(Scene& scene, const std::filesystem::path& file, AddMesh&& add_mesh) {
  const io::ObjFile obj = io::read_obj(file);
  for (const std::string& name : obj.mesh.material_names) {
    const auto mtl = obj.materials.find(name);
    const auto material = io::material_from_mtl(name, mtl == obj.materials.end() ? nullptr : &mtl->second);
    if (material && !scene.find_material(name)) scene.add_material(*material);
  }
  add_mesh(obj.mesh);
}

/// Patches, through files, into a scene without devices.
inline Scene scene_through_files(const Patches& scenery, const std::vector<MovingPatches>& objects = {}) {
  const TemporaryFolder folder;
  write_law_materials(folder / "laws.mtl");
  Scene scene;
  if (!scenery.empty()) {
    write_patches(folder / "scenery.obj", scenery);
    add_obj_file(scene, folder / "scenery.obj", [&](const TriangleMesh& mesh) { scene.set_scenery(mesh); });
  }
  for (const MovingPatches& object : objects) {
    write_patches(folder / (object.id + ".obj"), object.patches);
    add_obj_file(scene, folder / (object.id + ".obj"),
                 [&](const TriangleMesh& mesh) { scene.add_object(object.id, mesh, object.motion); });
  }
  return scene;
}

inline Antenna antenna(PolarizationKind kind) {
  return {0.0, {kind, 0.0}};
}

inline constexpr double law_frequency_hz = 28e9;

/// Exact discovery by name, on one thread, without diffraction: a law about edges asks for it.
inline SimulationSettings law_settings(int reflections, int transmissions, Discovery discovery = Discovery::exact) {
  SimulationSettings settings;
  settings.frequency_hz = law_frequency_hz;
  settings.propagation.max_reflections = reflections;
  settings.propagation.max_transmissions = transmissions;
  settings.propagation.max_diffractions = 0;
  settings.propagation.discovery = discovery;
  settings.threads = 1;
  return settings;
}

/// The paths of the one link between two dual-polarized devices.
inline std::vector<PathContribution> paths_between(Scene scene, const Vec3& transmitter_m, const Vec3& receiver_m,
                                                   const SimulationSettings& settings,
                                                   PolarizationKind polarization = PolarizationKind::dual) {
  scene.add_transmitter(device_at("tx", transmitter_m, 0.0, antenna(polarization)));
  scene.add_receiver(device_at("rx", receiver_m, 0.0, antenna(polarization)));
  Simulator simulator(std::move(scene), settings);
  return std::move(simulator.advance_to(0.0).links.at(0).paths);
}

inline std::string kinds(const PathContribution& contribution) {
  return dcem::kinds(contribution.path);
}

inline int reflections(const PathContribution& contribution) {
  const std::string letters = kinds(contribution);
  return static_cast<int>(std::count(letters.begin(), letters.end(), 'R'));
}

// Shapes ----------------------------------------------------------------------------------------------------------

/// The six faces of the box between two corners: x-, x+, y-, y+, z-, z+.
inline Patches box_faces(const Vec3& low_m, const Vec3& high_m, const std::string& material) {
  Patches faces;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double level : {low_m[axis], high_m[axis]}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      Patch face{{4, Vec3(0.0)}, material};
      const std::array<std::array<double, 2>, 4> corners{
          {{low_m[u], low_m[v]}, {high_m[u], low_m[v]}, {high_m[u], high_m[v]}, {low_m[u], high_m[v]}}};
      for (std::size_t corner = 0; corner < 4; ++corner) {
        face.corners_m[corner][axis] = level;
        face.corners_m[corner][u] = corners[corner][0];
        face.corners_m[corner][v] = corners[corner][1];
      }
      faces.push_back(face);
    }
  }
  return faces;
}

/// A parallelogram around its centre.
inline Patch sheet(const Vec3& centre_m, const Vec3& half_u_m, const Vec3& half_v_m, const std::string& material) {
  return {{centre_m - half_u_m - half_v_m, centre_m + half_u_m - half_v_m, centre_m + half_u_m + half_v_m,
           centre_m - half_u_m + half_v_m},
          material};
}

/// Right-handed rotation by an angle about an axis (Rodrigues).
inline Mat3 rotation_about(const Vec3& axis, double angle_rad) {
  const Vec3 n = glm::normalize(axis);
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const auto column = [&](const Vec3& e) { return c * e + s * glm::cross(n, e) + (1.0 - c) * glm::dot(n, e) * n; };
  return Mat3(column(Vec3(1, 0, 0)), column(Vec3(0, 1, 0)), column(Vec3(0, 0, 1)));
}

template <typename Map>
Patches mapped(Patches patches, Map&& map) {
  for (Patch& patch : patches) {
    for (Vec3& corner : patch.corners_m) corner = map(corner);
  }
  return patches;
}

/// Draws numbers for scenes; the same on every machine.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : stream_(hash_values(seed, 0x1a35ULL)) {}
  double between(double low, double high) { return low + (high - low) * stream_.uniform(); }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(stream_.next() % count); }
  Vec3 inside(const Vec3& low, const Vec3& high) {
    return {between(low.x, high.x), between(low.y, high.y), between(low.z, high.z)};
  }
  Vec3 direction() {
    const double z = between(-1.0, 1.0), azimuth = between(-pi, pi), radius = std::sqrt(1.0 - z * z);
    return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
  }
  template <typename Value>
  void shuffle(std::vector<Value>& values) {
    for (std::size_t last = values.size(); last > 1; --last) std::swap(values[last - 1], values[below(last)]);
  }
  std::string material(const std::vector<std::string>& names) { return names[below(names.size())]; }

 private:
  RandomStream stream_;
};

struct RandomRoom {
  Patches patches;
  Vec3 size_m;
  Vec3 transmitter_m, receiver_m;
};

/// A room with `sheets` tilted sheets and `boxes` turned closed boxes in the air, of opaque and transmissive materials.
inline RandomRoom random_room(std::uint64_t seed, std::size_t sheets, std::size_t boxes) {
  Dice dice(seed);
  RandomRoom room;
  room.size_m = dice.inside(Vec3(6, 5, 2.5), Vec3(14, 11, 5));
  room.patches = box_faces(Vec3(0.0), room.size_m, "half_space");
  for (Patch& wall : room.patches)
    wall.material = dice.material({"opaque", "wall", "half_space", "pec", "itu_concrete"});
  const auto somewhere = [&](double margin_m) { return dice.inside(Vec3(margin_m), room.size_m - margin_m); };
  for (std::size_t index = 0; index < sheets; ++index) {
    const Vec3 u = dice.direction(), v = glm::normalize(glm::cross(u, dice.direction()));
    room.patches.push_back(sheet(somewhere(0.3), dice.between(0.5, 2.0) * u, dice.between(0.4, 1.2) * v,
                                 dice.material({"wall", "glass", "lossless", "lossy", "opaque"})));
  }
  for (std::size_t index = 0; index < boxes; ++index) {
    const Vec3 half = dice.inside(Vec3(0.2), Vec3(1.1, 0.9, 0.6)), centre = somewhere(0.8);
    const Mat3 turn = rotation_about(Vec3(0, 0, 1), dice.between(-pi, pi));
    const Patches box = box_faces(-half, half, dice.material({"glass", "wall", "opaque", "pec", "lossy"}));
    for (const Patch& face : mapped(box, [&](const Vec3& p) { return centre + turn * p; }))
      room.patches.push_back(face);
  }
  room.transmitter_m = somewhere(0.2);
  room.receiver_m = somewhere(0.2);
  return room;
}

/// A storey as architects draw it: everything upright, partitions from wall to wall with a doorway each, cupboards
/// without a bottom on the floor. Planes are parallel, patches share planes and edges, sheets end on walls.
inline RandomRoom furnished_room(std::uint64_t seed) {
  Dice dice(seed);
  RandomRoom room;
  room.size_m = dice.inside(Vec3(8, 6, 2.6), Vec3(14, 10, 3.4));
  const double length = room.size_m.x, width = room.size_m.y, height = room.size_m.z;
  room.patches = box_faces(Vec3(0.0), room.size_m, "opaque");
  room.patches[0].material = "glass";
  room.patches[3].material = "wall";
  for (const double share : {0.3, 0.7}) {
    const double x = length * (share + dice.between(-0.05, 0.05)), y = width * dice.between(0.3, 0.6);
    const std::string material = dice.material({"wall", "glass", "opaque"});
    room.patches.push_back({{Vec3(x, 0, 0), Vec3(x, y, 0), Vec3(x, y, height), Vec3(x, 0, height)}, material});
    room.patches.push_back(
        {{Vec3(x, y + 1, 0), Vec3(x, width, 0), Vec3(x, width, height), Vec3(x, y + 1, height)}, material});
    room.patches.push_back(
        {{Vec3(x, y, 2.1), Vec3(x, y + 1, 2.1), Vec3(x, y + 1, height), Vec3(x, y, height)}, material});
  }
  const Vec3 low(dice.between(0.2, length - 1.5), dice.between(0.2, width - 1.5), 0.0);
  Patches cupboard = box_faces(low, low + dice.inside(Vec3(0.5, 0.4, 0.7), Vec3(1.2, 1.0, 2.0)), "pec");
  cupboard.erase(cupboard.begin() + 4);
  room.patches.insert(room.patches.end(), cupboard.begin(), cupboard.end());
  room.transmitter_m = dice.inside(Vec3(0.2), room.size_m - 0.2);
  room.receiver_m = dice.inside(Vec3(0.2), room.size_m - 0.2);
  return room;
}

// Numbers as they are -------------------------------------------------------------------------------------------------

/// Every number of a path, so that two results can be compared bit for bit.
inline std::vector<double> all_numbers(const PathContribution& path) {
  std::vector<double> numbers{path.path.length_m,
                              path.delay_s,
                              path.doppler_hz,
                              path.power_ratio,
                              path.departure.azimuth_rad,
                              path.departure.zenith_rad,
                              path.arrival.azimuth_rad,
                              path.arrival.zenith_rad,
                              path.amplitude.real(),
                              path.amplitude.imag(),
                              double(path.transmit_ports),
                              double(path.has_amplitude)};
  for (const ComplexMatrix2* matrix : {&path.transfer, &path.ports}) {
    for (std::size_t entry = 0; entry < 4; ++entry) {
      numbers.push_back((*matrix)(entry / 2, entry % 2).real());
      numbers.push_back((*matrix)(entry / 2, entry % 2).imag());
    }
  }
  for (const Interaction& interaction : path.path.interactions) {
    numbers.insert(numbers.end(), {double(interaction.kind), double(interaction.in_shadow), interaction.point_m.x,
                                   interaction.point_m.y, interaction.point_m.z});
  }
  return numbers;
}

/// Every number of the statistics, each with a 1 before it; an absent one is two zeros.
inline std::vector<double> all_numbers(const LinkStatistics& s) {
  std::vector<double> numbers{double(s.line_of_sight), double(s.path_count)};
  for (const auto& value :
       {s.power_dbm, s.power_incoherent_dbm, s.power_los_dbm, s.power_reflected_dbm, s.power_transmitted_dbm,
        s.power_diffracted_dbm, s.path_gain_db, s.first_delay_s, s.mean_delay_s, s.rms_delay_spread_s, s.k_factor_db,
        s.azimuth_spread_arrival_rad, s.azimuth_spread_departure_rad, s.mean_doppler_hz, s.rms_doppler_spread_hz}) {
    numbers.push_back(value ? 1.0 : 0.0);
    numbers.push_back(value.value_or(0.0));
  }
  return numbers;
}

inline void append_bits(std::string& bytes, const std::vector<double>& numbers) {
  for (const double number : numbers) bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// All that a link says, as bytes; facets by their names, which do not depend on anything but geometry.
inline std::string bits(const Scene& scene, const LinkResult& link) {
  std::string bytes = scene.transmitters()[link.transmitter].id + ">" + (link.complete ? "c" : "s");
  append_bits(bytes, all_numbers(link.statistics));
  for (const PathContribution& path : link.paths) {
    bytes += path_id(scene, path.path);
    append_bits(bytes, all_numbers(path));
  }
  return bytes;
}

}  // namespace dcem::test
