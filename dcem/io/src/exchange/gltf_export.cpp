#include "dcem/io/src/exchange/gltf_export.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "dcem/core/units.hpp"
#include "dcem/io/src/pictures/colour_map.hpp"
#include "dcem/io/src/results/link_entries.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

using Json = GltfDocument::Json;
using Mode = GltfDocument::Mode;

/// Light and muted for what stands, so that rays stand out.
constexpr std::array<Colour, 8> surface_colours{{{213, 205, 189},
                                                 {185, 198, 209},
                                                 {194, 207, 182},
                                                 {216, 191, 178},
                                                 {198, 190, 208},
                                                 {179, 201, 198},
                                                 {220, 211, 168},
                                                 {188, 188, 188}}};

Vec3 middle_m(std::span<const Vec3> points_m) {
  Vec3 low = points_m.front(), high = low;
  for (const Vec3& point_m : points_m) low = glm::min(low, point_m), high = glm::max(high, point_m);
  return 0.5 * (low + high);
}

/// Puts the scene as it stands, device by device and link by link, into a document.
class GltfScene {
 public:
  GltfScene(const Scene& scene, std::span<const Device> receivers, const Frame& instant)
      : scene_(scene), receivers_(receivers), instant_(instant) {
    for (std::size_t index = 0; index < scene.materials().size(); ++index) {
      document_.add_material(scene.materials()[index].name, surface_colours[index % surface_colours.size()]);
    }
    ray_material_ = document_.add_unlit_material("rays");
    add_bodies();
    add_devices();
  }

  void add_rays(const FrameResult& frame, const GltfSettings& settings, bool with_tiles);
  std::string bytes() const { return document_.bytes("t = " + format_fixed(instant_.time_s, 3) + " s"); }

 private:
  struct Ray {
    std::size_t link = 0;
    const Path* path = nullptr;
    double power_dbm = 0.0;
  };

  void add_bodies();
  void add_devices();
  Json surfaces(const SurfaceMesh& mesh, const Vec3& centre_m);
  std::vector<Ray> strongest(const FrameResult& frame, std::size_t most, bool with_tiles) const;
  void add_link(const LinkResult& link, std::span<const Ray> rays, double top_dbm, double range_db);

  const Scene& scene_;
  std::span<const Device> receivers_;
  const Frame& instant_;
  GltfDocument document_;
  std::size_t ray_material_ = 0;
};

void GltfScene::add_bodies() {
  for (std::size_t body = 0; body < instant_.bodies.size(); ++body) {
    const BodyState& state = instant_.bodies[body];
    const SurfaceMesh& mesh = scene_.body(BodyId(body)).mesh;
    if (!state.present || mesh.vertices_m.empty()) continue;
    const Vec3 centre_m = body == 0 ? middle_m(mesh.vertices_m) : Vec3(0.0);
    const Pose pose = body == 0 ? Pose{centre_m} : state.placement.pose;
    const std::size_t node = document_.add_node(body == 0 ? "scenery" : scene_.body_name(BodyId(body)), pose);
    document_.set_mesh(node, document_.add_mesh(surfaces(mesh, centre_m)));
  }
}

/// One primitive for each material.
Json GltfScene::surfaces(const SurfaceMesh& mesh, const Vec3& centre_m) {
  std::vector<std::vector<std::uint32_t>> indices(mesh.material_names.size());
  for (std::size_t triangle = 0; triangle < mesh.triangles.size(); ++triangle) {
    auto& list = indices[mesh.facets[mesh.facet_of_triangle[triangle]].material];
    list.insert(list.end(), mesh.triangles[triangle].begin(), mesh.triangles[triangle].end());
  }
  const std::size_t points = document_.add_points(mesh.vertices_m, centre_m);
  Json primitives = Json::array();
  for (std::size_t material = 0; material < indices.size(); ++material) {
    if (indices[material].empty()) continue;
    const std::size_t number = scene_.find_material(mesh.material_names[material])->value;
    Json primitive = GltfDocument::primitive(Mode::triangles, points, number);
    primitive["indices"] = document_.add_indices(indices[material]);
    primitives.push_back(std::move(primitive));
  }
  return primitives;
}

void GltfScene::add_devices() {
  for (const auto devices : {scene_.transmitters(), receivers_}) {
    for (const Device& device : devices) {
      const DeviceState state = scene_.device_state(device, instant_);
      if (state.present) document_.add_node(device.id, Pose{state.position_m});
    }
  }
}

std::vector<GltfScene::Ray> GltfScene::strongest(const FrameResult& frame, std::size_t most, bool with_tiles) const {
  std::vector<Ray> rays;
  for (std::size_t link = 0; link < frame.links.size(); ++link) {
    const double power_dbm = scene_.transmitters()[frame.links[link].transmitter].power_dbm;
    for (const LinkEntry& entry : link_entries(frame.links[link], with_tiles)) {
      if (!(entry.power_ratio() > 0.0)) continue;
      rays.push_back({link, &entry.geometry(), power_dbm + power_ratio_to_db(entry.power_ratio())});
    }
  }
  std::stable_sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) { return a.power_dbm > b.power_dbm; });
  if (rays.size() > most) rays.resize(most);
  return rays;
}

void GltfScene::add_rays(const FrameResult& frame, const GltfSettings& settings, bool with_tiles) {
  std::vector<Ray> rays = strongest(frame, settings.max_rays, with_tiles);
  if (rays.empty()) return;
  const double top_dbm = rays.front().power_dbm;
  std::stable_sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) { return a.link < b.link; });
  for (auto first = rays.begin(); first != rays.end();) {
    const auto last = std::find_if(first, rays.end(), [&](const Ray& ray) { return ray.link != first->link; });
    add_link(frame.links[first->link], {first, last}, top_dbm, settings.range_db);
    first = last;
  }
}

/// The rays of a link are one mesh of lines, strongest first, about its transmitter.
void GltfScene::add_link(const LinkResult& link, std::span<const Ray> rays, double top_dbm, double range_db) {
  const Device& tx = scene_.transmitters()[link.transmitter];
  const Device& rx = receivers_[link.receiver];
  const Vec3 from_m = scene_.device_state(tx, instant_).position_m, to_m = scene_.device_state(rx, instant_).position_m;
  std::vector<Vec3> ends_m;
  std::vector<Colour> colours;
  Json powers_dbm = Json::array();
  for (const Ray& ray : rays) {
    Vec3 last_m = from_m;
    const auto go = [&](const Vec3& point_m) {
      ends_m.insert(ends_m.end(), {last_m, point_m});
      last_m = point_m;
    };
    for (const Interaction& at : ray.path->interactions) go(at.point_m);
    go(to_m);
    colours.resize(ends_m.size(), viridis(1.0 + (ray.power_dbm - top_dbm) / range_db));
    powers_dbm.push_back(ray.power_dbm);
  }
  Json lines = GltfDocument::primitive(Mode::lines, document_.add_points(ends_m, from_m), ray_material_);
  lines["attributes"]["COLOR_0"] = document_.add_colours(colours);
  const std::size_t node = document_.add_node(tx.id + " to " + rx.id, Pose{from_m});
  document_.set_mesh(node, document_.add_mesh(Json::array({lines})));
  document_.set_extras(node, {{"tx", tx.id}, {"rx", rx.id}, {"received_power_dbm", powers_dbm}});
}

}  // namespace

GltfExport::GltfExport(const ExportContext& context)
    : file_(context.folder.open("scene.glb")),
      scene_(context.scene),
      receivers_(context.receivers),
      settings_(context.output.exchange.gltf_settings),
      chosen_(settings_.frame.value_or(context.facts.first_frame)),
      diffuse_paths_(context.facts.diffuse_paths) {
  const std::size_t first = context.facts.first_frame, last = first + context.facts.frames - 1;
  if (chosen_ >= first && chosen_ <= last) return;
  throw std::invalid_argument("output.gltf.frame: " + std::to_string(chosen_) +
                              " is not among the frames of this run; expected one from " + std::to_string(first) +
                              " to " + std::to_string(last));
}

void GltfExport::add(const FrameResult& frame, const Frame& instant) {
  if (frame.index != chosen_ && !bytes_.empty()) return;
  GltfScene scene(scene_, receivers_, instant);
  scene.add_rays(frame, settings_, diffuse_paths_);
  bytes_ = scene.bytes();
}

void GltfExport::finish() {
  file_.write(bytes_);
  file_.close();
}

}  // namespace dcem::io
