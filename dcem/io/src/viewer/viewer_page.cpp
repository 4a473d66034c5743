#include "dcem/io/src/viewer/viewer_page.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "dcem/io/src/pictures/colour_map.hpp"

namespace dcem::io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t absent = 0xffffffff;

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      group = group << 8 | (i < count ? static_cast<unsigned char>(bytes[at + i]) : 0U);
    }
    for (std::size_t i = 0; i < 4; ++i) text.push_back(i <= count ? digits[group >> (18 - 6 * i) & 63U] : '=');
  }
  return text;
}

/// An array of the page: little-endian numbers.
class PageArray {
 public:
  void add(std::uint32_t value) { append(value, 4); }
  void add(float value) { append(std::bit_cast<std::uint32_t>(value), 4); }
  void add(double value) { append(std::bit_cast<std::uint64_t>(value), 8); }
  void add(const Vec3& point) {
    for (int axis = 0; axis < 3; ++axis) add(static_cast<float>(point[axis]));
  }
  /// Single precision; what is absent or not finite is NaN, always the same one.
  void number(const std::optional<double>& value) {
    const float single = value ? static_cast<float>(*value) : 0.0F;
    value&& std::isfinite(single) ? add(single) : add(std::uint32_t{0x7fc00000});
  }

  void write(AtomicFile& file, std::string_view name, std::string_view type) const {
    file.write("<script type=\"text/plain\" data-type=\"" + std::string(type) + "\" id=\"" + std::string(name) + "\">");
    constexpr std::size_t piece = 3 * (std::size_t{1} << 18);  // whole groups of base64
    for (std::size_t at = 0; at < bytes_.size(); at += piece)
      file.write(base64(std::string_view(bytes_).substr(at, piece)));
    file.write("</script>\n");
  }

 private:
  void append(std::uint64_t bits, int count) {
    for (int byte = 0; byte < count; ++byte) bytes_.push_back(static_cast<char>(bits >> (8 * byte) & 255U));
  }

  std::string bytes_;
};

/// Gives each text a number, in the order in which they come.
template <typename Key>
class Numbering {
 public:
  std::uint32_t of(const Key& key) {
    const auto [place, is_new] = numbers_.try_emplace(key, static_cast<std::uint32_t>(keys_.size()));
    if (is_new) keys_.push_back(key);
    return place->second;
  }
  const std::vector<Key>& keys() const { return keys_; }

 private:
  std::map<Key, std::uint32_t> numbers_;
  std::vector<Key> keys_;
};

/// Light and muted for what stands, so that rays stand out; dark for what moves.
constexpr std::array<std::string_view, 8> standing_colours{"#d5cdbd", "#b9c6d1", "#c2cfb6", "#d8bfb2",
                                                           "#c6bed0", "#b3c9c6", "#dcd3a8", "#bcbcbc"};
constexpr std::array<std::string_view, 4> moving_colours{"#77838f", "#8f7f6d", "#6f8a7b", "#87779a"};

/// The scene, and its shapes once each.
class ScenePart {
 public:
  ScenePart(const Scene& scene, const Vec3& centre_m) : scene_(scene), centre_m_(centre_m) {
    colours_.resize(scene.materials().size());
    for (std::size_t body = 0; body < scene.bodies().size(); ++body) add(BodyId(body));
  }

  void describe(Json& head) const {
    Json materials = Json::array();
    for (std::size_t index = 0; index < colours_.size(); ++index) {
      const std::string colour(colours_[index].empty() ? "#bcbcbc" : colours_[index]);
      materials.push_back(
          {{"name", scene_.materials()[index].name}, {"colour", colour}, {"used", !colours_[index].empty()}});
    }
    head["materials"] = std::move(materials);
    head["meshes"] = meshes_;
    head["bodies"] = bodies_;
  }

  void write(AtomicFile& file) const {
    vertices_.write(file, "vertices", "f32");
    triangles_.write(file, "triangles", "u32");
    triangle_materials_.write(file, "triangle_material", "u32");
  }

 private:
  void add(BodyId id) {
    const SurfaceMesh& mesh = scene_.body(id).mesh;
    std::uint32_t number = find(mesh);
    if (number == shapes_.size() || id.value == 0) {
      number = static_cast<std::uint32_t>(shapes_.size());
      shapes_.push_back(&mesh);
      append(mesh, id.value == 0);
    }
    bodies_.push_back({{"mesh", number}});
  }

  /// A shape that is the same; the scenery has a place of its own, because it is moved to the centre.
  std::uint32_t find(const SurfaceMesh& mesh) const {
    std::uint32_t number = 1;
    while (number < shapes_.size() && !same_shape(*shapes_[number], mesh)) ++number;
    return std::max(number, static_cast<std::uint32_t>(std::min<std::size_t>(1, shapes_.size())));
  }

  static bool same_shape(const SurfaceMesh& a, const SurfaceMesh& b) {
    const auto material = [](const SurfaceMesh& mesh, std::size_t triangle) -> const std::string& {
      return mesh.material_names[mesh.facets[mesh.facet_of_triangle[triangle]].material];
    };
    if (a.vertices_m != b.vertices_m || a.triangles != b.triangles) return false;
    for (std::size_t triangle = 0; triangle < a.triangles.size(); ++triangle) {
      if (material(a, triangle) != material(b, triangle)) return false;
    }
    return true;
  }

  void append(const SurfaceMesh& mesh, bool is_scenery) {
    meshes_.push_back({{"first_vertex", vertex_count_},
                       {"vertices", mesh.vertices_m.size()},
                       {"first_triangle", triangle_count_},
                       {"triangles", mesh.triangles.size()}});
    for (const Vec3& vertex_m : mesh.vertices_m) vertices_.add(is_scenery ? vertex_m - centre_m_ : vertex_m);
    for (const auto& corners : mesh.triangles) {
      for (const std::uint32_t corner : corners) triangles_.add(corner);
    }
    for (const std::uint32_t facet : mesh.facet_of_triangle) {
      const MaterialId material = *scene_.find_material(mesh.material_names[mesh.facets[facet].material]);
      triangle_materials_.add(static_cast<std::uint32_t>(material.value));
      give_colour(material, is_scenery);
    }
    vertex_count_ += mesh.vertices_m.size();
    triangle_count_ += mesh.triangles.size();
  }

  void give_colour(MaterialId material, bool is_scenery) {
    std::string_view& colour = colours_[material.value];
    if (!colour.empty()) return;
    colour = is_scenery ? standing_colours[standing_++ % standing_colours.size()]
                        : moving_colours[moving_++ % moving_colours.size()];
  }

  const Scene& scene_;
  Vec3 centre_m_;
  std::vector<const SurfaceMesh*> shapes_;
  std::vector<std::string_view> colours_;
  std::size_t standing_ = 0, moving_ = 0, vertex_count_ = 0, triangle_count_ = 0;
  Json meshes_ = Json::array(), bodies_ = Json::array();
  PageArray vertices_, triangles_, triangle_materials_;
};

/// What changes from frame to frame.
class FramePart {
 public:
  FramePart(const std::vector<ViewedFrame>& frames, const Vec3& centre_m) : centre_m_(centre_m) {
    names_.of("");  // of devices
    // All of them are there, also where nothing comes to stand in them.
    for (const char* name : {"frame_index", "frame_links", "frame_poses", "pose_thing", "pose_name", "link_tx",
                             "link_rx", "link_paths", "link_listed", "link_rays", "ray_path", "map_obstructed"}) {
      counts(name);
    }
    for (const char* name : {"pose", "link_power", "link_diffuse", "link_k_factor", "link_delay_spread", "ray_length",
                             "ray_gain", "ray_doppler", "ray_points", "map_values"}) {
      numbers(name);
    }
    for (const ViewedFrame& frame : frames) add(frame);
    add_maps(frames);
  }

  void describe(Json& head) const {
    head["names"] = names_.keys();
    Json paths = Json::array();
    for (const auto& [kinds, id] : paths_.keys()) paths.push_back({kinds, id});
    head["paths"] = std::move(paths);
    head["maps"] = maps_;
  }

  void write(AtomicFile& file) const {
    for (const auto& [name, array] : arrays_) array.write(file, name.first, name.second);
  }

 private:
  PageArray& counts(const char* name) { return arrays_[{name, "u32"}]; }
  PageArray& numbers(const char* name) { return arrays_[{name, "f32"}]; }

  void add(const ViewedFrame& frame) {
    counts("frame_index").add(static_cast<std::uint32_t>(frame.index));
    arrays_[{"frame_time", "f64"}].add(frame.time_s);
    counts("frame_links").add(static_cast<std::uint32_t>(frame.links.size()));
    counts("frame_poses").add(static_cast<std::uint32_t>(frame.changes.size()));
    for (const ViewedPose& pose : frame.changes) add(pose);
    for (const ViewedLink& link : frame.links) add(link);
  }

  void add(const ViewedPose& pose) {
    counts("pose_thing").add(static_cast<std::uint32_t>(pose.thing));
    counts("pose_name").add(pose.present ? names_.of(pose.name) : absent);
    PageArray& values = numbers("pose");
    values.add(pose.present ? pose.pose.position_m - centre_m_ : Vec3(0.0));
    for (const double angle_rad : {pose.pose.yaw_rad, pose.pose.pitch_rad, pose.pose.roll_rad})
      values.number(angle_rad);
  }

  void add(const ViewedLink& link) {
    const LinkStatistics& values = link.statistics;
    counts("link_tx").add(static_cast<std::uint32_t>(link.transmitter));
    counts("link_rx").add(static_cast<std::uint32_t>(link.receiver));
    counts("link_paths").add(static_cast<std::uint32_t>(values.path_count));
    counts("link_listed").add(static_cast<std::uint32_t>(link.listed));
    counts("link_rays").add(static_cast<std::uint32_t>(link.rays.size()));
    numbers("link_power").number(values.power_dbm);
    numbers("link_diffuse").number(values.power_diffuse_dbm);
    numbers("link_k_factor").number(values.k_factor_db);
    const auto spread_s = values.rms_delay_spread_s;
    numbers("link_delay_spread").number(spread_s ? std::optional(1e9 * *spread_s) : std::nullopt);
    for (const ViewedRay& ray : link.rays) add(ray);
  }

  void add(const ViewedRay& ray) {
    counts("ray_path").add(paths_.of({ray.kinds, ray.id}));
    numbers("ray_length").number(ray.length_m);
    numbers("ray_gain").number(ray.gain_db);
    numbers("ray_doppler").number(ray.doppler_hz);
    for (const Vec3& point_m : ray.points_m) numbers("ray_points").add(point_m - centre_m_);
  }

  void add_maps(const std::vector<ViewedFrame>& frames) {
    PageArray& values = numbers("map_values");
    std::size_t first = 0;
    std::uint32_t bits = 0;
    for (std::size_t place = 0; place < frames.size(); ++place) {
      for (const ViewedMap& map : frames[place].maps) {
        const Vec3 corner_m = map.corner_m - centre_m_;
        maps_.push_back({{"grid", map.grid},
                         {"tx", map.transmitter},
                         {"frame", place},
                         {"corner_m", {corner_m.x, corner_m.y, corner_m.z}},
                         {"spacing_m", map.spacing_m},
                         {"columns", map.columns},
                         {"rows", map.rows},
                         {"first", first}});
        for (std::size_t point = 0; point < map.power_dbm.size(); ++point, ++first) {
          values.number(map.power_dbm[point]);
          if (map.obstructed[point]) bits |= 1U << (first % 32);
          if (first % 32 == 31) counts("map_obstructed").add(std::exchange(bits, 0));
        }
      }
    }
    counts("map_obstructed").add(bits);
  }

  Vec3 centre_m_;
  Numbering<std::string> names_;
  Numbering<std::pair<std::string, std::string>> paths_;
  Json maps_ = Json::array();
  std::map<std::pair<std::string, std::string>, PageArray> arrays_;  // by name and type
};

/// Single precision holds a millimetre up to 16 km from here.
Vec3 centre_of(const Scene& scene, const ViewerFrames& frames) {
  Aabb<double> box;
  for (const Vec3& vertex_m : scene.body(BodyId(0)).mesh.vertices_m) box.extend(vertex_m);
  const auto& changes = frames.frames().front().changes;
  if (box.empty() && !changes.empty()) box.extend(changes.front().pose.position_m);
  if (box.empty()) return Vec3(0.0);
  return {std::round(0.5 * (box.min.x + box.max.x)), std::round(0.5 * (box.min.y + box.max.y)), 0.0};
}

Json device_json(const Scene& scene, Json& receivers) {
  Json transmitters = Json::array();
  for (const Device& device : scene.transmitters()) {
    transmitters.push_back({{"id", device.id}, {"power_dbm", device.power_dbm}});
  }
  receivers = Json::array();
  for (const Device& device : scene.receivers()) receivers.push_back(device.id);
  return transmitters;
}

Json viridis_json() {
  constexpr std::size_t points = 18;  // those that the table of colours has
  Json colours = Json::array();
  for (std::size_t point = 0; point < points; ++point) {
    const Colour colour = viridis(static_cast<double>(point) / static_cast<double>(points - 1));
    colours.push_back({colour.red, colour.green, colour.blue});
  }
  return colours;
}

/// JSON that may stand in a script element: a "<" could begin its end.
std::string script_text(const Json& content) {
  const std::string plain = content.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  for (const char character : plain) character == '<' ? text += "\\u003c" : text += character;
  return text;
}

Json head_json(const Scene& scene, const ViewerFacts& facts, const ViewerFrames& frames, const Vec3& centre_m) {
  Json head{{"format", "dcem-viewer/1"},
            {"scenario", facts.scenario},
            {"frequency_hz", facts.frequency_hz},
            {"first_frame", facts.first_frame},
            {"frames", frames.seen()},
            {"centre_m", {centre_m.x, centre_m.y, centre_m.z}},
            {"notices", frames.notices()},
            {"viridis", viridis_json()}};
  Json receivers;
  head["transmitters"] = device_json(scene, receivers);
  head["receivers"] = std::move(receivers);
  return head;
}

}  // namespace

void write_viewer_page(AtomicFile& file, const Scene& scene, const ViewerFacts& facts, const ViewerFrames& frames) {
  const Vec3 centre_m = centre_of(scene, frames);
  const ScenePart surfaces(scene, centre_m);
  const FramePart moments(frames.frames(), centre_m);
  Json head = head_json(scene, facts, frames, centre_m);
  surfaces.describe(head);
  moments.describe(head);
  const std::map<std::string_view, std::function<void()>> parts{
      {"style", [&] { file.write(viewer_style()); }},
      {"three", [&] { file.write(viewer_three()); }},
      {"script", [&] { file.write(viewer_script()); }},
      {"head", [&] { file.write(script_text(head)); }},
      {"arrays", [&] { surfaces.write(file), moments.write(file); }}};
  constexpr std::string_view mark = "@dcem:";
  std::string_view page = viewer_html();
  for (std::size_t at = page.find(mark); at != std::string_view::npos; at = page.find(mark)) {
    file.write(page.substr(0, at));
    page.remove_prefix(at + mark.size());
    const std::size_t end = page.find('@');
    parts.at(page.substr(0, end))();
    page.remove_prefix(end + 1);
  }
  file.write(page);
}

}  // namespace dcem::io
