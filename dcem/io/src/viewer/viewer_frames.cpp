#include "dcem/io/src/viewer/viewer_frames.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "dcem/core/units.hpp"
#include "dcem/io/src/results/path_lines.hpp"
#include "dcem/paths/path_id.hpp"

namespace dcem::io {
namespace {

/// Frames are thinned before a link keeps fewer paths than this.
constexpr std::size_t least_paths_per_link = 8;

/// The later changes over the earlier ones, ascending by thing.
std::vector<ViewedPose> merged(const std::vector<ViewedPose>& earlier, std::vector<ViewedPose> later) {
  if (earlier.empty()) return later;
  const auto by_thing = [](const ViewedPose& a, const ViewedPose& b) { return a.thing < b.thing; };
  std::vector<ViewedPose> both;
  // Where both have a thing, set_union takes the one of the first range.
  std::set_union(later.begin(), later.end(), earlier.begin(), earlier.end(), std::back_inserter(both), by_thing);
  return both;
}

std::vector<ViewedPose> poses_of(const Scene& scene, const Frame& frame) {
  std::vector<ViewedPose> poses;
  for (std::size_t body = 1; body < frame.bodies.size(); ++body) {
    const BodyState& state = frame.bodies[body];
    ViewedPose pose{body, state.present, {}, {}};
    if (state.present) pose.name = scene.body(BodyId(body)).is_slot ? state.occupant : scene.body(BodyId(body)).id;
    if (state.present) pose.pose = state.placement.pose;
    poses.push_back(std::move(pose));
  }
  std::size_t thing = frame.bodies.size();
  for (const auto devices : {scene.transmitters(), scene.receivers()}) {
    for (const Device& device : devices) {
      const DeviceState state = scene.device_state(device, frame);
      poses.push_back({thing++, state.present, {}, {}});
      if (state.present) poses.back().pose.position_m = state.position_m;
    }
  }
  return poses;
}

/// Those of `now` that differ from `before`; a thing that was never there does not differ from one that is absent.
std::vector<ViewedPose> changes_between(const std::vector<ViewedPose>& before, const std::vector<ViewedPose>& now) {
  std::vector<ViewedPose> changes;
  for (std::size_t index = 0; index < now.size(); ++index) {
    const bool same = before.empty() ? !now[index].present : now[index] == before[index];
    if (!same) changes.push_back(now[index]);
  }
  return changes;
}

/// A path or a listed tile with its power.
struct Candidate {
  const PathContribution* path = nullptr;
  const DiffuseContribution* tile = nullptr;
  double power_ratio = 0.0;
};

std::vector<Candidate> candidates_of(const LinkResult& link) {
  std::vector<Candidate> candidates;
  for (const PathContribution& path : link.paths) candidates.push_back({&path, nullptr, path.power_ratio});
  for (const DiffuseContribution& tile : link.diffuse.tiles) {
    if (!tile.path.interactions.empty()) candidates.push_back({nullptr, &tile, tile.sample.power_ratio});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.power_ratio > b.power_ratio; });
  return candidates;
}

ViewedRay ray_of(const Scene& scene, const Candidate& candidate, ViewedSurfaces& surfaces) {
  const Path& path = candidate.path != nullptr ? candidate.path->path : candidate.tile->path;
  ViewedRay ray{kinds(path),
                candidate.path != nullptr ? path_id(scene, path) : tile_id(scene, *candidate.tile),
                path.length_m,
                power_ratio_to_db(candidate.power_ratio),
                candidate.path != nullptr ? candidate.path->doppler_hz : candidate.tile->sample.doppler_hz,
                {}};
  for (const Interaction& interaction : path.interactions)
    ray.touches.push_back({interaction.point_m, surfaces.number_of(scene, interaction)});
  return ray;
}

}  // namespace

ViewerFrames::ViewerFrames(std::size_t map_values_per_frame, const ViewerSettings& settings) : settings_(settings) {
  while (map_values_per_frame / (map_step_ * map_step_) > 10 * settings.max_rays) ++map_step_;
}

void ViewerFrames::add(const Scene& scene, const Frame& frame, const FrameResult& result) {
  keeps_last_ = seen_++ % step_ == 0;
  if (!keeps_last_) return;
  std::vector<ViewedPose> now = poses_of(scene, frame);
  ViewedFrame kept{frame.index, frame.time_s, merged(carry_, changes_between(last_, now)), {}, {}};
  carry_.clear();
  last_ = std::move(now);
  const std::size_t most_links = std::max<std::size_t>(1, settings_.max_rays / 2);
  if (result.links.size() > most_links) most_links_ = std::max(most_links_, result.links.size());
  for (const LinkResult& link : result.links) {
    if (kept.links.size() == most_links) break;
    kept.links.push_back(view_of_link(scene, link));
  }
  frames_.push_back(std::move(kept));
  keep_bounds();
}

ViewedLink ViewerFrames::view_of_link(const Scene& scene, const LinkResult& link) {
  const std::vector<Candidate> candidates = candidates_of(link);
  ViewedLink viewed{link.transmitter, link.receiver, link.statistics, candidates.size(), {}};
  const std::size_t count = std::min({candidates.size(), paths_per_link_, settings_.max_rays});
  for (std::size_t index = 0; index < count; ++index)
    viewed.rays.push_back(ray_of(scene, candidates[index], surfaces_));
  return viewed;
}

void ViewerFrames::add(std::span<const RadioMap> maps, const CombinedMap& combined, bool has_noise) {
  if (!keeps_last_ || maps.empty()) return;
  const MapPlaces& places = maps.front().places;
  std::size_t step = map_step_;
  if (!places.is_grid()) {
    step = 1 + places.size() * (maps.size() + 2) / (10 * settings_.max_rays);
    list_step_ = std::max(list_step_, step);
  }
  frames_.back().maps.push_back(view_of_maps(maps, combined, has_noise, step));
  keep_bounds();
}

std::size_t ViewerFrames::links() const {
  return std::accumulate(frames_.begin(), frames_.end(), std::size_t{0},
                         [](std::size_t sum, const ViewedFrame& frame) { return sum + frame.links.size(); });
}

std::size_t ViewerFrames::poses() const {
  return std::accumulate(frames_.begin(), frames_.end(), std::size_t{0},
                         [](std::size_t sum, const ViewedFrame& frame) { return sum + frame.changes.size(); });
}

std::size_t ViewerFrames::rays(std::size_t most_per_link) const {
  std::size_t sum = 0;
  for (const ViewedFrame& frame : frames_) {
    for (const ViewedLink& link : frame.links) sum += std::min(link.rays.size(), most_per_link);
  }
  return sum;
}

std::size_t ViewerFrames::map_values() const {
  std::size_t sum = 0;
  for (const ViewedFrame& frame : frames_) {
    for (const ViewedMap& map : frame.maps) sum += map.value_count();
  }
  return sum;
}

void ViewerFrames::keep_bounds() {
  const auto too_many = [&] {
    return frames_.size() > settings_.max_frames || links() > settings_.max_rays / 2 ||
           poses() > settings_.max_rays / 2 || map_values() > 10 * settings_.max_rays;
  };
  while (can_be_thinned() && too_many()) thin_frames();
  while (can_be_thinned() && rays(least_paths_per_link) > settings_.max_rays) thin_frames();
  if (rays(paths_per_link_) > settings_.max_rays) limit_paths();
}

void ViewerFrames::limit_paths() {
  std::size_t low = 1, high = std::min(paths_per_link_, settings_.max_rays);
  while (low < high) {
    const std::size_t middle = low + (high - low + 1) / 2;
    if (rays(middle) <= settings_.max_rays) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  paths_per_link_ = low;
  for (ViewedFrame& frame : frames_) {
    for (ViewedLink& link : frame.links) link.rays.resize(std::min(link.rays.size(), paths_per_link_));
  }
}

void ViewerFrames::thin_frames() {
  step_ *= 2;
  std::vector<ViewedFrame> kept;
  std::vector<ViewedPose> pending;
  for (std::size_t place = 0; place < frames_.size(); ++place) {
    pending = merged(pending, std::move(frames_[place].changes));
    if (place % 2 != 0) continue;
    frames_[place].changes = std::exchange(pending, {});
    kept.push_back(std::move(frames_[place]));
  }
  keeps_last_ = frames_.size() % 2 != 0;
  frames_ = std::move(kept);
  carry_ = std::move(pending);
}

std::vector<std::string> ViewerFrames::notices() const {
  std::vector<std::string> lines;
  std::size_t most = 0;
  for (const ViewedFrame& frame : frames_) {
    for (const ViewedLink& link : frame.links) most = std::max(most, link.listed);
  }
  if (step_ > 1 && seen_ > 1) {
    lines.push_back("one of every " + std::to_string(step_) + " of " + std::to_string(seen_) + " frames is shown");
  }
  if (paths_per_link_ < most) {
    lines.push_back("the " + std::to_string(paths_per_link_) + " strongest of up to " + std::to_string(most) +
                    " paths per link are shown");
  }
  if (most_links_ > 0) {
    lines.push_back("the first " + std::to_string(settings_.max_rays / 2) + " of up to " + std::to_string(most_links_) +
                    " links per frame are shown");
  }
  if (map_step_ > 1)
    lines.push_back("one of every " + std::to_string(map_step_) + " points of a map along each axis is shown");
  if (list_step_ > 1) lines.push_back("one of every " + std::to_string(list_step_) + " points of a list is shown");
  return lines;
}

}  // namespace dcem::io
