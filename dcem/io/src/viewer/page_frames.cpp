#include "dcem/io/src/viewer/page_frames.hpp"

#include "dcem/core/units.hpp"

namespace dcem::io {
namespace {

constexpr std::uint32_t absent = 0xffffffff;

}  // namespace

PageFrames::PageFrames(const ViewerFrames& frames, const Vec3& centre_m)
    : centre_m_(centre_m), surfaces_(frames.surfaces()) {
  names_.of("");  // of devices, and of the scenery
  arrays_.announce(
      {"frame_index", "frame_links", "frame_poses", "pose_thing", "pose_name", "link_tx", "link_rx", "link_paths",
       "link_listed", "link_rays", "ray_path", "path_surfaces", "surface_object", "surface_material"},
      {"pose", "link_power", "link_diffuse", "link_k_factor", "link_delay_spread", "ray_length", "ray_gain",
       "ray_doppler", "ray_points", "surface_axes", "surface_exterior"});
  for (const ViewedFrame& frame : frames.frames()) add(frame);
}

void PageFrames::describe(nlohmann::ordered_json& head) const {
  head["names"] = names_.keys();
  auto paths = nlohmann::ordered_json::array();
  for (const auto& [kinds, id] : paths_.keys()) paths.push_back({kinds, id});
  head["paths"] = std::move(paths);
}

void PageFrames::add(const ViewedFrame& frame) {
  arrays_.counts("frame_index").add(static_cast<std::uint32_t>(frame.index));
  arrays_.instants("frame_time").add(frame.time_s);
  arrays_.counts("frame_links").add(static_cast<std::uint32_t>(frame.links.size()));
  arrays_.counts("frame_poses").add(static_cast<std::uint32_t>(frame.changes.size()));
  for (const ViewedPose& pose : frame.changes) add(pose);
  for (const ViewedLink& link : frame.links) add(link);
}

void PageFrames::add(const ViewedPose& pose) {
  arrays_.counts("pose_thing").add(static_cast<std::uint32_t>(pose.thing));
  arrays_.counts("pose_name").add(pose.present ? names_.of(pose.name) : absent);
  PageArray& values = arrays_.numbers("pose");
  values.add(pose.present ? pose.pose.position_m - centre_m_ : Vec3(0.0));
  for (const double angle_rad : {pose.pose.yaw_rad, pose.pose.pitch_rad, pose.pose.roll_rad}) values.number(angle_rad);
}

void PageFrames::add(const ViewedLink& link) {
  const LinkStatistics& values = link.statistics;
  arrays_.counts("link_tx").add(static_cast<std::uint32_t>(link.transmitter));
  arrays_.counts("link_rx").add(static_cast<std::uint32_t>(link.receiver));
  arrays_.counts("link_paths").add(static_cast<std::uint32_t>(values.path_count));
  arrays_.counts("link_listed").add(static_cast<std::uint32_t>(link.listed));
  arrays_.counts("link_rays").add(static_cast<std::uint32_t>(link.rays.size()));
  arrays_.numbers("link_power").number(values.power_dbm);
  arrays_.numbers("link_diffuse").number(values.power_diffuse_dbm);
  arrays_.numbers("link_k_factor").number(values.k_factor_db);
  const auto spread_s = values.rms_delay_spread_s;
  arrays_.numbers("link_delay_spread").number(spread_s ? std::optional(1e9 * *spread_s) : std::nullopt);
  for (const ViewedRay& ray : link.rays) add(ray);
}

void PageFrames::add(const ViewedRay& ray) {
  arrays_.counts("ray_path").add(path_number(ray));
  arrays_.numbers("ray_length").number(ray.length_m);
  arrays_.numbers("ray_gain").number(ray.gain_db);
  arrays_.numbers("ray_doppler").number(ray.doppler_hz);
  for (const ViewedTouch& touch : ray.touches) arrays_.numbers("ray_points").add(touch.point_m - centre_m_);
}

/// A path that is new brings the surfaces of its points along.
std::uint32_t PageFrames::path_number(const ViewedRay& ray) {
  const std::size_t before = paths_.keys().size();
  const std::uint32_t number = paths_.of({ray.kinds, ray.id});
  if (number < before) return number;
  for (const ViewedTouch& touch : ray.touches) arrays_.counts("path_surfaces").add(surface_number(touch.surface));
  return number;
}

std::uint32_t PageFrames::surface_number(std::uint32_t viewed) {
  const std::size_t before = surface_numbers_.keys().size();
  const std::uint32_t number = surface_numbers_.of(viewed);
  if (number < before) return number;
  const ViewedSurface& surface = surfaces_[viewed];
  arrays_.counts("surface_object").add(names_.of(surface.object));
  arrays_.counts("surface_material").add(static_cast<std::uint32_t>(surface.material.value));
  arrays_.numbers("surface_axes").add(surface.normal);
  arrays_.numbers("surface_axes").add(surface.edge);
  arrays_.numbers("surface_exterior").number(radians_to_degrees(surface.exterior_angle_rad));
  return number;
}

}  // namespace dcem::io
