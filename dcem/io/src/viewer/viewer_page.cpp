#include "dcem/io/src/viewer/viewer_page.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "dcem/io/src/pictures/colour_map.hpp"
#include "dcem/io/src/viewer/page_frames.hpp"
#include "dcem/io/src/viewer/page_maps.hpp"
#include "dcem/io/src/viewer/page_scene.hpp"

namespace dcem::io {
namespace {

using Json = nlohmann::ordered_json;

/// Single precision holds a millimetre up to 16 km from here.
Vec3 centre_of(const Scene& scene, const ViewerFrames& frames) {
  Aabb<double> box;
  for (const Vec3& vertex_m : scene.body(BodyId(0)).mesh.vertices_m) box.extend(vertex_m);
  const auto& changes = frames.frames().front().changes;
  if (box.empty() && !changes.empty()) box.extend(changes.front().pose.position_m);
  if (box.empty()) return Vec3(0.0);
  return {std::round(0.5 * (box.min.x + box.max.x)), std::round(0.5 * (box.min.y + box.max.y)), 0.0};
}

std::string hex_text(const Colour& colour) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text = "#";
  for (const unsigned value : {colour.red, colour.green, colour.blue}) {
    text += digits[value >> 4];
    text += digits[value & 15U];
  }
  return text;
}

Json device_json(const Scene& scene, Json& receivers) {
  Json transmitters = Json::array();
  for (const Device& device : scene.transmitters()) {
    const std::string colour = hex_text(category_colour(transmitters.size()));
    transmitters.push_back({{"id", device.id}, {"power_dbm", device.power_dbm}, {"colour", colour}});
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
            {"notes", facts.notes},
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
  const PageScene surfaces(scene, centre_m);
  const PageFrames moments(frames, centre_m);
  const PageMaps maps(frames, centre_m);
  Json head = head_json(scene, facts, frames, centre_m);
  surfaces.describe(head);
  moments.describe(head);
  maps.describe(head);
  const std::map<std::string_view, std::function<void()>> parts{
      {"style", [&] { file.write(viewer_style()); }},
      {"three", [&] { file.write(viewer_three()); }},
      {"script", [&] { file.write(viewer_script()); }},
      {"head", [&] { file.write(script_text(head)); }},
      {"arrays", [&] { surfaces.write(file), moments.write(file), maps.write(file); }}};
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
