#include "dcem/io/src/exchange/deepmimo_export.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "dcem/core/units.hpp"
#include "dcem/io/src/results/array_parts.hpp"

namespace dcem::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t most_deepmimo_files = 100'000, files_per_transmitter = 11;
const std::string deepmimo_root = "deepmimo/";

/// DeepMIMO's digit for an interaction (consts.py).
unsigned deepmimo_digit(InteractionKind kind) {
  switch (kind) {
    case InteractionKind::reflection:
      return 1;
    case InteractionKind::diffraction:
      return 2;
    case InteractionKind::scattering:
      return 3;
    case InteractionKind::transmission:
      break;
  }
  return 4;
}

/// Its digits from the transmitter on, read as a decimal number; 0 the line of sight.
double deepmimo_code(const Path& path) {
  double code = 0.0;
  for (const Interaction& at : path.interactions) code = 10.0 * code + deepmimo_digit(at.kind);
  return code;
}

std::string numbered(const char* form, std::size_t number) {
  std::array<char, 64> name{};
  std::snprintf(name.data(), name.size(), form, number);
  return name.data();
}

Json set_of(const std::string& name, std::size_t id, bool sends, std::size_t points) {
  return {{"name", name},
          {"id_orig", id},
          {"id", id},
          {"is_tx", sends},
          {"is_rx", !sends},
          {"num_points", points},
          {"num_active_points", points},
          {"num_ant", 1},
          {"dual_pol", false},
          {"ant_rel_positions", {{0, 0, 0}}},
          {"array_orientation", {0, 0, 0}},
          {"grid_spacing", nullptr}};
}

}  // namespace

DeepMimoExport::DeepMimoExport(const ExportContext& context)
    : folder_(context.folder),
      scene_(context.scene),
      receivers_(context.receivers),
      frequency_hz_(context.facts.frequency_hz),
      has_frames_(context.facts.frames > 1),
      parameters_(context.folder.open(deepmimo_root + "params.json")) {
  require_single_ports(context, "output.deepmimo: a path has one phase in DeepMIMO's arrays");
  const std::size_t files = context.facts.frames * files_per_transmitter * scene_.transmitters().size();
  if (files <= most_deepmimo_files) return;
  throw std::invalid_argument("output.deepmimo: frames and transmitters need " + std::to_string(files) +
                              " files; expected at most " + std::to_string(most_deepmimo_files) + " (fewer frames)");
}

std::string DeepMimoExport::folder_of(std::size_t number) const {
  return has_frames_ ? deepmimo_root + numbered("scene_%06zu/", number) : deepmimo_root;
}

void DeepMimoExport::add(const FrameResult& frame, const Frame& instant) {
  const std::string folder = folder_of(frames_++);
  for (std::size_t tx = 0; tx < scene_.transmitters().size(); ++tx) {
    write_transmitter(folder, tx, paths_of(frame, tx), instant);
  }
  write_scene(folder, instant);
}

/// By receiver, strongest first; what an antenna does not hear at all is left out.
std::vector<DeepMimoExport::Paths> DeepMimoExport::paths_of(const FrameResult& frame, std::size_t transmitter) {
  std::vector<Paths> all(receivers_.size());
  for (const LinkResult& link : frame.links) {
    if (link.transmitter != transmitter) continue;
    Paths& paths = all[link.receiver];
    for (const PathContribution& path : link.paths) {
      if (path.power_ratio > 0.0) paths.push_back(&path);
      count(path);
    }
    std::stable_sort(paths.begin(), paths.end(), [](const PathContribution* a, const PathContribution* b) {
      return a->power_ratio > b->power_ratio;
    });
  }
  return all;
}

void DeepMimoExport::count(const PathContribution& path) {
  std::array<std::size_t, 5> of_kind{};
  for (const Interaction& at : path.path.interactions) ++of_kind[deepmimo_digit(at.kind)];
  of_kind[0] = path.path.interactions.size();
  for (std::size_t kind = 0; kind < of_kind.size(); ++kind) {
    most_of_kind_[kind] = std::max(most_of_kind_[kind], of_kind[kind]);
  }
}

void DeepMimoExport::write_transmitter(const std::string& folder, std::size_t transmitter,
                                       const std::vector<Paths>& paths, const Frame& instant) {
  std::size_t longest = 1;
  for (const Paths& list : paths) longest = std::max(longest, list.size());
  // The arrays' names end with the set and number of the transmitter and the set of the receivers.
  const std::string end = numbered("_t000_tx%03zu_r001.npz", transmitter);
  write_fields(folder + "%" + end, paths, longest);
  write_interactions(folder + "%" + end, paths, longest);
  write_places(folder + "%" + end, transmitter, instant);
}

void DeepMimoExport::write_array(const std::string& name, const std::string& key, const NpzWriter::Shape& shape,
                                 const std::vector<double>& values) {
  NpzWriter npz(NpzCompression::deflate);
  npz.add(key, shape, std::span<const double>(values));
  std::string file_name = name;
  AtomicFile& file = folder_.open(file_name.replace(file_name.find('%'), 1, key));
  npz.write(file);
  file.close();
}

void DeepMimoExport::write_fields(const std::string& end, const std::vector<Paths>& paths, std::size_t longest) {
  const auto write = [&](const char* key, double (*value)(const PathContribution&)) {
    std::vector<double> values(paths.size() * longest, nothing);
    for (std::size_t rx = 0; rx < paths.size(); ++rx) {
      for (std::size_t slot = 0; slot < paths[rx].size(); ++slot) values[rx * longest + slot] = value(*paths[rx][slot]);
    }
    write_array(end, key, {paths.size(), longest}, values);
  };
  using Ray = PathContribution;
  write("power", [](const Ray& ray) { return power_ratio_to_db(ray.power_ratio); });
  write("phase", [](const Ray& ray) { return radians_to_degrees(std::arg(ray.amplitude)); });
  write("delay", [](const Ray& ray) { return ray.delay_s; });
  write("aoa_az", [](const Ray& ray) { return radians_to_degrees(ray.arrival.azimuth_rad); });
  write("aoa_el", [](const Ray& ray) { return radians_to_degrees(ray.arrival.zenith_rad); });
  write("aod_az", [](const Ray& ray) { return radians_to_degrees(ray.departure.azimuth_rad); });
  write("aod_el", [](const Ray& ray) { return radians_to_degrees(ray.departure.zenith_rad); });
  write("inter", [](const Ray& ray) { return deepmimo_code(ray.path); });
}

void DeepMimoExport::write_interactions(const std::string& end, const std::vector<Paths>& paths, std::size_t longest) {
  std::size_t deepest = 1;
  for (const Paths& list : paths) {
    for (const PathContribution* path : list) deepest = std::max(deepest, path->path.interactions.size());
  }
  std::vector<double> points(paths.size() * longest * deepest * 3, nothing);
  for (std::size_t rx = 0; rx < paths.size(); ++rx) {
    for (std::size_t slot = 0; slot < paths[rx].size(); ++slot) {
      std::size_t place = (rx * longest + slot) * deepest * 3;
      for (const Interaction& at : paths[rx][slot]->path.interactions) {
        for (const double coordinate : {at.point_m.x, at.point_m.y, at.point_m.z}) points[place++] = coordinate;
      }
    }
  }
  write_array(end, "inter_pos", {paths.size(), longest, deepest, 3}, points);
}

/// Where a device is not there, its place is no number.
void DeepMimoExport::write_places(const std::string& end, std::size_t transmitter, const Frame& instant) {
  const auto append = [&](std::vector<double>& values, const Device& device) {
    const DeviceState state = scene_.device_state(device, instant);
    const Vec3 at_m = state.present ? state.position_m : Vec3(nothing);
    values.insert(values.end(), {at_m.x, at_m.y, at_m.z});
  };
  std::vector<double> receivers, sender;
  for (const Device& device : receivers_) append(receivers, device);
  append(sender, scene_.transmitters()[transmitter]);
  write_array(end, "rx_pos", {receivers_.size(), 3}, receivers);
  write_array(end, "tx_pos", {1, 3}, sender);
}

/// Every body that is there as a mesh of its own.
void DeepMimoExport::write_scene(const std::string& folder, const Frame& instant) {
  NpzWriter faces(NpzCompression::deflate), materials(NpzCompression::deflate);
  std::vector<double> vertices;
  Json objects = Json::array();
  for (std::size_t body = 0; body < instant.bodies.size(); ++body) {
    const SurfaceMesh& mesh = scene_.body(BodyId(body)).mesh;
    if (!instant.bodies[body].present || mesh.triangles.empty()) continue;
    const auto first = static_cast<std::uint32_t>(vertices.size() / 3);
    const Pose& pose = instant.bodies[body].placement.pose;
    const Mat3 turn = rotation_matrix(pose);
    for (const Vec3& vertex_m : mesh.vertices_m) {
      const Vec3 at_m = body == 0 ? vertex_m : pose.position_m + turn * vertex_m;
      vertices.insert(vertices.end(), {at_m.x, at_m.y, at_m.z});
    }
    std::vector<std::uint32_t> corners, kinds;
    for (std::size_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
      for (const std::uint32_t corner : mesh.triangles[triangle]) corners.push_back(first + corner);
      const Facet& facet = mesh.facets[mesh.facet_of_triangle[triangle]];
      kinds.push_back(static_cast<std::uint32_t>(scene_.find_material(mesh.material_names[facet.material])->value));
    }
    const std::string key = std::to_string(objects.size());
    faces.add(key, {mesh.triangles.size(), 3}, std::span<const std::uint32_t>(corners));
    materials.add(key, {kinds.size()}, std::span<const std::uint32_t>(kinds));
    const std::string name = body == 0 ? "scenery" : scene_.body_name(BodyId(body));
    objects.push_back(
        {{"name", name}, {"label", body == 0 ? "buildings" : "objects"}, {"id", objects.size()}, {"mesh_key", key}});
    triangles_ += frames_ == 1 ? mesh.triangles.size() : 0;
  }
  if (frames_ == 1) objects_ = objects.size(), vertices_ = vertices.size() / 3;
  if (objects.empty()) return;
  write_array(folder + "%.npz", "vertices", {vertices.size() / 3, 3}, vertices);
  for (const auto& [name, npz] :
       {std::pair<const char*, NpzWriter*>{"faces.npz", &faces}, {"materials.npz", &materials}}) {
    AtomicFile& file = folder_.open(folder + name);
    npz->write(file);
    file.close();
  }
  AtomicFile& list = folder_.open(folder + "objects.json");
  list.write(objects.dump(1) + "\n");
  list.close();
}

/// Of the search the most that any path has: what was allowed is in summary.json.
std::string DeepMimoExport::parameters() const {
  Json materials = Json::object();
  for (std::size_t index = 0; index < scene_.materials().size(); ++index) {
    // Permittivity and conductivity are the engine's own affair: most of its materials are no half spaces.
    materials["material_" + std::to_string(index)] = {
        {"id", index}, {"name", scene_.materials()[index].name}, {"permittivity", 1.0}, {"conductivity", 0.0}};
  }
  const Json document{{"version", "4.0.5"},
                      {"rt_params",
                       {{"raytracer_name", "DCEM"},
                        {"raytracer_version", ""},
                        {"frequency", frequency_hz_},
                        {"max_path_depth", most_of_kind_[0]},
                        {"max_reflections", most_of_kind_[1]},
                        {"max_diffractions", most_of_kind_[2]},
                        {"max_scattering", most_of_kind_[3]},
                        {"max_transmissions", most_of_kind_[4]}}},
                      {"txrx_sets",
                       {{"txrx_set_0", set_of("transmitters", 0, true, scene_.transmitters().size())},
                        {"txrx_set_1", set_of("receivers", 1, false, receivers_.size())}}},
                      {"materials", materials},
                      {"scene",
                       {{"num_scenes", frames_},
                        {"n_objects", objects_},
                        {"n_vertices", vertices_},
                        {"n_faces", triangles_},
                        {"n_triangular_faces", triangles_},
                        {"representation", "mesh"}}},
                      {"dcem", {{"tx_id", ids_of(scene_.transmitters())}, {"rx_id", ids_of(receivers_)}}}};
  return document.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void DeepMimoExport::finish() {
  parameters_.write(parameters());
  parameters_.close();
}

}  // namespace dcem::io
