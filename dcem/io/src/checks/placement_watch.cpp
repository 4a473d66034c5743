#include "dcem/io/placement_watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dcem/accel/wide_index.hpp"
#include "dcem/io/src/checks/frame_ranges.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

constexpr double far_m = 1000.0;            ///< outside the scene
constexpr double below_m = 0.01;            ///< under its lowest point: more than dirt
constexpr double wall_reach_m = 200.0;      ///< as far as the walls of a room may be
constexpr std::size_t most_named = 5;       ///< of each kind of misplacement
constexpr std::size_t most_watched = 1000;  ///< receivers that are looked at in each frame; of more, the first ones
constexpr std::size_t most_asked = 200;     ///< receivers and points that are asked whether they share a shell

double outside_m(const Aabb<double>& box, const Vec3& point_m, int axis) {
  return std::max({0.0, box.min[axis] - point_m[axis], point_m[axis] - box.max[axis]});
}

/// Horizontally. What flies or orbits is seen at more than 45 degrees and may be that far away.
double far_away_m(const Aabb<double>& box, const Vec3& point_m) {
  const double across_m = std::hypot(outside_m(box, point_m, 0), outside_m(box, point_m, 1));
  const bool is_high = point_m.z - box.max.z > across_m;
  return across_m > far_m && !is_high ? across_m : 0.0;
}

/// Nothing where there is no surface.
std::optional<Vec3> middle_of(const SurfaceMesh& mesh) {
  Aabb<double> box;
  for (const Vec3& vertex : mesh.vertices_m) box.extend(vertex);
  return box.empty() ? std::nullopt : std::optional(0.5 * (box.min + box.max));
}

std::string metres(double length_m) {
  return length_m < 1000.0 ? format_fixed(length_m, length_m < 10.0 ? 2 : 0) + " m"
                           : format_fixed(length_m / 1000.0, length_m < 1e5 ? 1 : 0) + " km";
}

}  // namespace

PlacementWatch::PlacementWatch(std::string file, const Simulator& simulator, std::span<const Device> receivers,
                               std::span<const ReceiverGrid> grids)
    : file_(std::move(file)), simulator_(simulator), receivers_(receivers), grids_(grids) {
  for (const Body& body : simulator.scene().bodies()) middles_m_.push_back(middle_of(body.mesh));
}

void PlacementWatch::look(const Frame& frame) {
  frame_ = &frame;
  const Scene& scene = simulator_.scene();
  box_ = {};
  for (const Aabb<double>& triangle : scene.triangle_boxes()) box_.extend(triangle);
  if (box_.empty()) return;
  rooms_.clear();
  for (const Device& device : scene.transmitters()) look_at_transmitter(device);
  for (const Device& device : receivers_.first(std::min(receivers_.size(), most_watched))) {
    look_at_receiver(device, "receiver " + in_quotes(device.id));
  }
  for (const ReceiverGrid& grid : grids_) look_at_grid(grid);
  for (std::uint32_t body = 1; body < scene.bodies().size(); ++body) look_at_object(BodyId(body));
}

void PlacementWatch::look_at_places(const Vec3& position_m, const std::string& subject) {
  if (const double away_m = far_away_m(box_, position_m); away_m > 0.0) {
    note(Problem::far_outside, subject,
         "is " + metres(away_m) + " outside the box of the scene; is it in other coordinates or another unit?");
  } else if (position_m.z < box_.min.z - below_m) {
    note(Problem::below_all, subject,
         "is " + metres(box_.min.z - position_m.z) + " below everything in the scene; is its height meant?");
  } else if (is_below_ground(position_m)) {
    note(Problem::below_ground, subject,
         "has a surface above and nothing below and beside it; is it under the ground?");
  }
}

void PlacementWatch::look_at_transmitter(const Device& device) {
  const DeviceState state = simulator_.scene().device_state(device, *frame_);
  if (!state.present) return;
  const std::string subject = "transmitter " + in_quotes(device.id);
  look_at_places(state.position_m, subject);
  for (const Shell& shell : simulator_.shells_around(state.position_m)) rooms_.insert(shell);
  for (const Shell& shell : closed_shells(state.position_m, &state)) {
    const double share = share_of_receivers_in(shell);
    if (share >= 0.5) continue;
    note(Problem::shut_in_alone, subject,
         "is inside " + name_of(shell) + ", which lets nothing through, and " +
             (share > 0.0 ? "only " + format_fixed(100.0 * share, 0) + " % of the receivers are" : "no receiver is") +
             " in there");
  }
}

void PlacementWatch::look_at_receiver(const Device& device, const std::string& subject) {
  const DeviceState state = simulator_.scene().device_state(device, *frame_);
  if (!state.present) return;
  look_at_places(state.position_m, subject);
  for (const Shell& shell : closed_shells(state.position_m, &state)) {
    if (rooms_.contains(shell)) continue;
    note(Problem::shut_in, subject,
         "is inside " + name_of(shell) + ", which lets nothing through, and no transmitter is in there");
  }
}

/// Points of a grid may lie in houses; a grid that lies nowhere near anything is a mistake.
void PlacementWatch::look_at_grid(const ReceiverGrid& grid) {
  const Vec3 first_m = grid_point_m(grid, 0, 0), last_m = grid_point_m(grid, grid.rows() - 1, grid.columns() - 1);
  const Vec3 nearest_m = glm::clamp(0.5 * (box_.min + box_.max), glm::min(first_m, last_m), glm::max(first_m, last_m));
  const std::string subject = "grid " + in_quotes(grid.id);
  if (const double away_m = far_away_m(box_, nearest_m); away_m > 0.0) {
    note(Problem::far_outside, subject,
         "is " + metres(away_m) + " outside the box of the scene; is it in other coordinates or another unit?");
  } else if (first_m.z < box_.min.z - below_m) {
    note(Problem::below_all, subject,
         "is " + metres(box_.min.z - first_m.z) + " below everything in the scene; is its height meant?");
  }
}

void PlacementWatch::look_at_object(BodyId body) {
  const Scene& scene = simulator_.scene();
  const BodyState& state = scene.body_state(body);
  if (!state.present || !middles_m_[body.value]) return;
  const Pose& pose = state.placement.pose;
  const Vec3 middle_m = pose.position_m + rotation_matrix(pose) * *middles_m_[body.value];
  const std::string subject = (scene.body(body).is_slot ? "vehicle " : "object ") + in_quotes(scene.body_name(body));
  for (const Shell& shell : simulator_.shells_around(middle_m)) {
    if (shell.first == body || rooms_.contains(shell)) continue;
    note(Problem::drives_through, subject, "is with its middle inside " + name_of(shell) + "; is its way meant?");
  }
}

void PlacementWatch::note(Problem problem, const std::string& subject, const std::string& detail) {
  const auto [number, is_new] = numbers_.try_emplace({problem, subject}, sightings_.size());
  if (is_new) sightings_.push_back({problem, subject, detail, {}});
  std::vector<std::size_t>& frames = sightings_[number->second].frames;
  if (frames.empty() || frames.back() != frame_->index) frames.push_back(frame_->index);
}

/// A room has walls beside it, and a hall has no floor only where a mesh lacks it: what has a surface above, nothing
/// below and a free way out on two sides at least is taken to be under the ground.
bool PlacementWatch::is_below_ground(const Vec3& position_m) const {
  const Scene& scene = simulator_.scene();
  const auto hit = [&](const Vec3& direction) {
    return simulator_.index().closest_hit(Ray<double>{position_m, direction}, HitFilter{}, nullptr);
  };
  constexpr double slope = 1e-3;  // no direction along a wall
  if (hit(Vec3(slope, 2.0 * slope, -1.0))) return false;
  const auto above = hit(Vec3(slope, 2.0 * slope, 1.0));
  if (!above || std::abs(scene.facet(scene.facet_of_triangle(above->triangle)).plane.normal.z) < 0.7) return false;
  int ways_out = 0;
  for (const Vec3& direction : {Vec3(1, slope, 0), Vec3(-1, slope, 0), Vec3(slope, 1, 0), Vec3(slope, -1, 0)}) {
    const auto beside = hit(direction);
    ways_out += !beside || beside->t > wall_reach_m ? 1 : 0;
  }
  return ways_out >= 2;
}

std::vector<PlacementWatch::Shell> PlacementWatch::closed_shells(const Vec3& point_m, const DeviceState* of) const {
  std::vector<Shell> shells = simulator_.shells_around(point_m);
  std::erase_if(shells, [&](const Shell& shell) {
    return (of != nullptr && of->ignored_body == shell.first) || lets_through(shell);
  });
  return shells;
}

bool PlacementWatch::lets_through(const Shell& shell) const {
  if (simulator_.settings().propagation.max_transmissions == 0) return false;
  const auto known = lets_through_.find(shell);
  if (known != lets_through_.end()) return known->second;
  const Scene& scene = simulator_.scene();
  const auto [first, last] = scene.triangle_range(shell.first);
  bool transmits = false;
  for (std::uint32_t triangle = first; triangle < last && !transmits; ++triangle) {
    transmits =
        scene.shell_of_triangle(triangle) == shell.second && scene.facet(scene.facet_of_triangle(triangle)).transmits;
  }
  return lets_through_[shell] = transmits;
}

double PlacementWatch::share_of_receivers_in(const Shell& shell) const {
  std::size_t asked = 0, inside = 0;
  const auto ask = [&](const Vec3& point_m) {
    const std::vector<Shell> around = simulator_.shells_around(point_m);
    ++asked;
    inside += std::find(around.begin(), around.end(), shell) != around.end() ? 1U : 0U;
  };
  for (std::size_t index = 0; index < std::min(receivers_.size(), most_asked); ++index) {
    const DeviceState state = simulator_.scene().device_state(receivers_[index], *frame_);
    if (state.present) ask(state.position_m);
  }
  for (const ReceiverGrid& grid : grids_) {
    const std::size_t step = std::max<std::size_t>(1, grid.size() / most_asked);
    for (std::size_t cell = step / 2; cell < grid.size(); cell += step) {
      ask(grid_point_m(grid, cell / grid.columns(), cell % grid.columns()));
    }
  }
  return asked == 0 ? 1.0 : static_cast<double>(inside) / static_cast<double>(asked);
}

std::string PlacementWatch::name_of(const Shell& shell) const {
  const Scene& scene = simulator_.scene();
  if (shell.first.value != 0) return in_quotes(scene.body_name(shell.first));
  const auto [first, last] = scene.triangle_range(shell.first);
  for (std::uint32_t triangle = first; triangle < last; ++triangle) {
    if (scene.shell_of_triangle(triangle) != shell.second) continue;
    const MaterialId material = scene.facet(scene.facet_of_triangle(triangle)).material;
    return "a closed part of the scenery (of " + in_quotes(scene.material(material).name) + ")";
  }
  return "a closed part of the scenery";
}

std::vector<std::string> PlacementWatch::warnings() const {
  std::vector<std::string> lines;
  std::map<Problem, std::size_t> named;
  for (const Sighting& sighting : sightings_) {
    if (++named[sighting.problem] > most_named) continue;
    lines.push_back(file_ + ": " + sighting.subject + " " + sighting.detail + " (" + frame_ranges(sighting.frames) +
                    ")");
  }
  for (const auto& entry : named) {
    if (entry.second <= most_named) continue;
    const auto first = std::find_if(sightings_.begin(), sightings_.end(),
                                    [&](const Sighting& sighting) { return sighting.problem == entry.first; });
    lines.push_back(file_ + ": " + std::to_string(entry.second - most_named) + " more are placed as " + first->subject +
                    " is");
  }
  return lines;
}

}  // namespace dcem::io
