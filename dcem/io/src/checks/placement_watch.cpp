#include "dcem/io/placement_watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <string_view>
#include <unordered_map>

#include "dcem/accel/wide_index.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/io/src/checks/frame_ranges.hpp"
#include "dcem/io/src/text/text_input.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

constexpr double far_m = 1000.0;                                ///< outside the scenery
constexpr double flying_height_m = 3000.0;                      ///< above it: aeroplanes, platforms, satellites
constexpr double flying_slope = 0.087;                          ///< tan 5°: lower ones hardly reach it
constexpr double balloon_height_m = 6e4, orbit_height_m = 1e5;  ///< between them nothing stays …
constexpr double moon_height_m = 4e8;                           ///< … and nothing that is sent to is higher
constexpr double one_point_m = 1e-9;                            ///< ends so near have no direct path
constexpr double below_m = 0.01;                                ///< more than dirt
constexpr double broad_m = 30.0;  ///< a ground goes on so far on all sides, a deck or a canopy does not
constexpr double room_m = 200.0;  ///< so far away the walls of a room may be
constexpr double moving_mps = 0.1;
constexpr std::size_t most_named = 5;       ///< of each kind of misplacement
constexpr std::size_t most_watched = 1000;  ///< receivers that are looked at in each frame; of more, the first ones
constexpr std::size_t most_compared = 64;   ///< transmitters that receivers are compared with: the first ones
constexpr std::size_t at_once = 8;          ///< devices or objects that a thread looks at
constexpr std::size_t most_asked = 200;     ///< receivers, and points of each grid, that are asked where they are

double outside_m(const Aabb<double>& box, const Vec3& point_m, int axis) {
  return std::max({0.0, box.min[axis] - point_m[axis], point_m[axis] - box.max[axis]});
}

double across_m(const Aabb<double>& box, const Vec3& point_m) {
  return std::hypot(outside_m(box, point_m, 0), outside_m(box, point_m, 1));
}

bool flies(double across_m, double height_m) {
  if ((height_m > balloon_height_m && height_m < orbit_height_m) || height_m > moon_height_m) return false;
  return height_m > across_m || (height_m > flying_height_m && height_m > flying_slope * across_m);
}

/// How far away, 0 within a kilometre. What flies may be that far away.
double far_away_m(const Aabb<double>& box, const Vec3& point_m, bool may_fly) {
  const double aside_m = across_m(box, point_m), height_m = std::max(0.0, point_m.z - box.max.z);
  const bool is_meant = std::max(aside_m, height_m) <= far_m || (may_fly && flies(aside_m, height_m));
  return is_meant ? 0.0 : std::hypot(aside_m, height_m);
}

bool is_near(const Aabb<double>& box, const Vec3& point_m) {
  return across_m(box, point_m) <= far_m && point_m.z - box.max.z <= flying_height_m;
}

Vec3 nearest_point_m(const ReceiverGrid& grid, const Vec3& to_m) {
  const Vec3 first_m = grid_point_m(grid, 0, 0), last_m = grid_point_m(grid, grid.rows() - 1, grid.columns() - 1);
  return glm::clamp(to_m, glm::min(first_m, last_m), glm::max(first_m, last_m));
}

/// Nothing where there is no surface.
std::optional<Vec3> middle_of(const SurfaceMesh& mesh) {
  Aabb<double> box;
  for (const Vec3& vertex : mesh.vertices_m) box.extend(vertex);
  return box.empty() ? std::nullopt : std::optional(0.5 * (box.min + box.max));
}

/// As a vehicle could stand on it.
bool lies_flat(const WorldFacet& facet) {
  return std::abs(facet.plane.normal.z) > 0.7;
}

std::string metres(double length_m) {
  return length_m < 1000.0 ? format_fixed(length_m, length_m < 10.0 ? 2 : 0) + " m"
                           : format_fixed(length_m / 1000.0, length_m < 1e5 ? 1 : 0) + " km";
}

}  // namespace

/// What is wrong with whom, and the rest of the sentence.
struct PlacementWatch::Sighting {
  Problem problem;
  std::string subject, detail;
  double extent_m = 0.0;  ///< the detail is that of the frame with the largest one
  FrameRuns frames;

  /// The same of the same subject, in other frames.
  void add(const Sighting& more) {
    frames.add(more.frames);
    if (more.extent_m <= extent_m) return;
    extent_m = more.extent_m;
    detail = more.detail;
  }
};

/// What has been seen of one device, grid or object, by the thread that looks at it. A vehicle that has left is
/// followed by another one in the same place of the scene: the subjects of a record may be several.
class PlacementWatch::Record {
 public:
  void begin(std::size_t frame) {
    frame_ = frame;
    seen_now_ = 0;
  }

  /// `detail()` is the rest of the sentence.
  template <typename Detail>
  void note(Problem problem, const std::string& subject, double extent_m, Detail&& detail) {
    const auto last = std::find_if(sightings_.rbegin(), sightings_.rend(), [&](const Sighting& sighting) {
      return sighting.problem == problem && sighting.subject == subject;
    });
    const bool is_new = last == sightings_.rend();
    if (is_new) sightings_.push_back({problem, subject, detail(), extent_m, {}});
    Sighting& sighting = is_new ? sightings_.back() : *last;
    if (extent_m > sighting.extent_m) {
      sighting.detail = detail();
      sighting.extent_m = extent_m;
    }
    sighting.frames.add(frame_);
    ++seen_now_;
  }

  bool nothing_noted() const { return seen_now_ == 0; }                  ///< in this frame
  const std::vector<Sighting>& sightings() const { return sightings_; }  ///< in the order in which they were seen first

 private:
  std::vector<Sighting> sightings_;
  std::size_t frame_ = 0, seen_now_ = 0;
};

PlacementWatch::PlacementWatch(std::string file, const Simulator& simulator, std::span<const Device> receivers,
                               std::span<const ReceiverGrid> grids, Links links)
    : file_(std::move(file)), simulator_(simulator), receivers_(receivers), grids_(grids), links_(links) {
  for (const Vec3& vertex : simulator.scene().body(BodyId{}).mesh.vertices_m) box_.extend(vertex);
  for (const Body& body : simulator.scene().bodies()) middles_m_.push_back(middle_of(body.mesh));
  houses_before_.resize(middles_m_.size());
}

PlacementWatch::~PlacementWatch() = default;

void PlacementWatch::look(const Frame& frame) {
  if (box_.empty()) return;
  frame_ = &frame;
  note_rooms();
  may_fly_ = anyone_is_near();
  const std::array<std::size_t, kinds> counts{rooms_.size(), std::min(receivers_.size(), most_watched), grids_.size(),
                                              simulator_.scene().bodies().size() - 1};
  for (std::size_t kind = 0; kind < kinds; ++kind) {
    if (records_[kind].size() < counts[kind]) records_[kind].resize(counts[kind]);
  }
  for_each(std::reduce(counts.begin(), counts.end()), [&](std::size_t number) {
    std::size_t kind = 0;
    for (; number >= counts[kind]; ++kind) number -= counts[kind];
    Record& record = records_[kind][number];
    record.begin(frame_->index);
    look_at(static_cast<Kind>(kind), number, record);
  });
}

void PlacementWatch::look_at(Kind kind, std::size_t number, Record& record) {
  switch (kind) {
    case Kind::transmitter:
      return look_at_transmitter(number, record);
    case Kind::receiver:
      return look_at_receiver(receivers_[number], record);
    case Kind::grid:
      return look_at_grid(grids_[number], record);
    case Kind::object:
      return look_at_object(BodyId(number + 1), record);
  }
}

template <typename Look>
void PlacementWatch::for_each(std::size_t count, Look&& look) const {
  simulator_.pool().for_each((count + at_once - 1) / at_once, [&](std::size_t block, unsigned) {
    for (std::size_t number = block * at_once; number < std::min(count, (block + 1) * at_once); ++number) look(number);
  });
}

void PlacementWatch::note_rooms() {
  const std::span<const Device> transmitters = simulator_.scene().transmitters();
  rooms_.assign(transmitters.size(), {});
  transmitters_m_.assign(transmitters.size(), std::nullopt);
  for_each(transmitters.size(), [&](std::size_t number) {
    const DeviceState state = simulator_.scene().device_state(transmitters[number], *frame_);
    if (!state.present) return;
    transmitters_m_[number] = state.position_m;
    for (const ShellAtPoint& at : simulator_.shells_at(state.position_m))
      rooms_[number].emplace_back(at.body, at.number);
  });
  all_rooms_.clear();
  for (const std::vector<Shell>& own : rooms_) all_rooms_.insert(own.begin(), own.end());
}

/// Of some link one end is near the scenery, or else the scenery has no part in any. Also where there is no link.
bool PlacementWatch::anyone_is_near() const {
  const Vec3 middle_m = 0.5 * (box_.min + box_.max);
  bool is_anyone_listening = !grids_.empty();
  for (const Device& receiver : receivers_) {
    const DeviceState state = simulator_.scene().device_state(receiver, *frame_);
    if (state.present && is_near(box_, state.position_m)) return true;
    is_anyone_listening = is_anyone_listening || state.present;
  }
  const auto transmits_near = [&](const auto& place_m) { return place_m && is_near(box_, *place_m); };
  return !is_anyone_listening ||
         std::ranges::none_of(transmitters_m_, [](const auto& place_m) { return place_m.has_value(); }) ||
         std::ranges::any_of(transmitters_m_, transmits_near) ||
         std::ranges::any_of(grids_, [&](const auto& grid) { return is_near(box_, nearest_point_m(grid, middle_m)); });
}

bool PlacementWatch::is_far(const Vec3& position_m, const std::string& subject, Record& record) const {
  const double away_m = far_away_m(box_, position_m, may_fly_);
  if (away_m == 0.0) return false;
  record.note(Problem::far_outside, subject, away_m, [&] {
    return "is up to " + metres(away_m) +
           " outside the box of the scenery; is it in other coordinates or another unit?";
  });
  return true;
}

void PlacementWatch::look_at_place(const Vec3& position_m, const std::string& subject, Record& record) const {
  if (is_far(position_m, subject, record) || !is_under_ground(position_m)) return;
  const double depth_m = box_.min.z - position_m.z;
  record.note(Problem::under_ground, subject, depth_m, [&] {
    return depth_m > below_m ? "is up to " + metres(depth_m) + " below everything in the scenery; is its height meant?"
                             : "has a broad surface above it and none below; is it under the ground?";
  });
}

void PlacementWatch::look_at_transmitter(std::size_t number, Record& record) const {
  const Device& device = simulator_.scene().transmitters()[number];
  const DeviceState state = simulator_.scene().device_state(device, *frame_);
  if (!state.present) return;
  const std::string subject = "transmitter " + in_quotes(device.id);
  look_at_place(state.position_m, subject, record);
  for (const Shell& shell : closed_shells(state)) {
    const double share = share_of_receivers_in(shell, {rooms_[number].begin(), rooms_[number].end()});
    if (share >= 0.5) continue;
    record.note(Problem::shut_in_alone, subject, 0.0, [&] {
      return "is inside " + name_of(shell) + ", and " +
             (share > 0.0 ? "only " + format_fixed(100.0 * share, 0) + " % of the receivers are" : "no receiver is") +
             " in there";
    });
  }
}

void PlacementWatch::look_at_receiver(const Device& device, Record& record) const {
  const DeviceState state = simulator_.scene().device_state(device, *frame_);
  if (!state.present) return;
  const std::string subject = "receiver " + in_quotes(device.id);
  look_at_place(state.position_m, subject, record);
  look_for_twin(device, state.position_m, subject, record);
  for (const Shell& shell : closed_shells(state)) {
    if (all_rooms_.contains(shell)) continue;
    record.note(Problem::shut_in, subject, 0.0,
                [&] { return "is inside " + name_of(shell) + ", and no transmitter is in there"; });
  }
}

/// Whether two different devices have a link, however near they are.
bool PlacementWatch::is_linked(const Device& transmitter, const Device& receiver) const {
  if (links_ == Links::all) return transmitter.id != receiver.id;
  if (transmitter.is_transceiver && receiver.is_transceiver && transmitter.id >= receiver.id) return false;
  const auto& pairs = simulator_.settings().links.pairs;
  return transmitter.id != receiver.id && (!pairs || std::ranges::any_of(*pairs, [&](const auto& pair) {
           return pair == std::pair(transmitter.id, receiver.id) ||
                  (transmitter.is_transceiver && pair == std::pair(receiver.id, transmitter.id));
         }));
}

/// A transmitter at the very point of a receiver: who wants no direct path may mean it.
void PlacementWatch::look_for_twin(const Device& device, const Vec3& position_m, const std::string& subject,
                                   Record& record) const {
  if (!simulator_.settings().propagation.line_of_sight) return;
  const std::span<const Device> transmitters = simulator_.scene().transmitters();
  for (std::size_t number = 0; number < std::min(transmitters.size(), most_compared); ++number) {
    const std::optional<Vec3>& other_m = transmitters_m_[number];
    if (!other_m || glm::distance(*other_m, position_m) > one_point_m || !is_linked(transmitters[number], device))
      continue;
    return record.note(Problem::at_one_point, subject, 0.0, [&] {
      return "is at the very point of transmitter " + in_quotes(transmitters[number].id) +
             ", and their link has no direct path";
    });
  }
}

/// Points of a grid may lie in houses; a grid that lies nowhere near anything is a mistake.
void PlacementWatch::look_at_grid(const ReceiverGrid& grid, Record& record) const {
  look_at_place(nearest_point_m(grid, 0.5 * (box_.min + box_.max)), "grid " + in_quotes(grid.id), record);
}

void PlacementWatch::look_at_object(BodyId body, Record& record) {
  const Scene& scene = simulator_.scene();
  const BodyState& state = scene.body_state(body);
  if (!state.present || !middles_m_[body.value]) return houses_before_[body.value].reset();
  const Pose& pose = state.placement.pose;
  const Vec3 middle_m = pose.position_m + rotation_matrix(pose) * *middles_m_[body.value];
  const std::string subject = (scene.body(body).is_slot ? "vehicle " : "object ") + in_quotes(scene.body_name(body));
  if (is_foliage(body)) return void(is_far(middle_m, subject, record));  // all woods of a town are one object
  look_at_place(middle_m, subject, record);
  if (record.nothing_noted()) look_at_way(body, middle_m, subject, record);
}

/// Vehicles drive into no house. Other objects may be in one that waves pass, as people are; but who was outside in the
/// frame before went through its wall.
void PlacementWatch::look_at_way(BodyId body, const Vec3& middle_m, const std::string& subject, Record& record) {
  const Scene& scene = simulator_.scene();
  const bool moves = glm::length(scene.body_state(body).placement.velocity.linear_mps) >= moving_mps;
  std::vector<Shell> houses;
  for (const ShellAtPoint& at : simulator_.shells_at(middle_m)) {
    const Shell shell{at.body, at.number};
    if (at.body == body || at.is_on_it || facts_of(shell).is_foliage) continue;
    const bool is_house = at.body == BodyId{} && lets_through(shell) && !scene.body(body).is_slot;
    if (is_house) houses.push_back(shell);
    if (is_house || !moves || all_rooms_.contains(shell) || moves_along(body, at.body)) continue;
    record.note(Problem::drives_through, subject, 0.0,
                [&] { return "is with its middle inside " + name_of(shell) + "; is its way meant?"; });
  }
  std::optional<std::vector<Shell>>& before = houses_before_[body.value];
  std::vector<Shell> crossed;
  if (before) std::ranges::set_symmetric_difference(houses, *before, std::back_inserter(crossed));
  for (const Shell& shell : crossed) {
    if (all_rooms_.contains(shell)) continue;
    record.note(Problem::goes_through, subject, 0.0,
                [&] { return "goes through a wall of " + name_of(shell) + "; is its way meant?"; });
  }
  before = std::move(houses);
}

/// Whether the scenery has a surface that a vehicle could stand on, or its underside, from a point in a direction.
bool PlacementWatch::ground_is_hit(const Vec3& from_m, const Vec3& direction) const {
  const Scene& scene = simulator_.scene();
  const auto counts = [&](const TriangleHit& hit) {
    const WorldFacet& facet = scene.facet(scene.facet_of_triangle(hit.triangle));
    return facet.body == BodyId{} && lies_flat(facet);
  };
  return simulator_.index().visit_hits(Ray<double>{from_m, direction}, HitFilter{}, counts, nullptr);
}

/// Whether what comes first in a horizontal direction is a wall. Under a slope it is the slope.
bool PlacementWatch::wall_is_near(const Vec3& from_m, const Vec3& aside) const {
  const Scene& scene = simulator_.scene();
  const auto is_scenery = [&](const TriangleHit& hit) {
    return scene.facet(scene.facet_of_triangle(hit.triangle)).body == BodyId{};
  };
  double nearest_m = room_m;
  bool is_wall = false;
  simulator_.index().visit_hits(
      Ray<double>{from_m, aside}, HitFilter{},
      [&](const TriangleHit& hit) {
        if (hit.t > nearest_m || !is_scenery(hit)) return false;
        nearest_m = hit.t;
        is_wall = !lies_flat(scene.facet(scene.facet_of_triangle(hit.triangle)));
        return false;
      },
      nullptr);
  return is_wall;
}

/// A ground is broad. A room has walls, a tunnel on two sides, and under a bridge or a canopy it is not far to the sky.
/// Down a slope the ground may end above a point that is as high as one under the ground, but not on all sides.
bool PlacementWatch::is_under_ground(const Vec3& position_m) const {
  constexpr double slope = 1e-3;  // no direction along a wall
  const Vec3 up(slope, 2.0 * slope, 1.0);
  if (ground_is_hit(position_m, -up) || !ground_is_hit(position_m, up)) return false;
  const std::array<Vec3, 4> sides{Vec3(1, slope, 0), Vec3(-1, slope, 0), Vec3(slope, 1, 0), Vec3(slope, -1, 0)};
  // One alone may be that of a house that is sunk into a slope.
  if (std::ranges::count_if(sides, [&](const Vec3& aside) { return wall_is_near(position_m, aside); }) > 1)
    return false;
  return std::ranges::all_of(sides, [&](const Vec3& aside) { return ground_goes_on(position_m + broad_m * aside); });
}

/// Whether there is ground over or under a point: to the side of one that is under the ground.
bool PlacementWatch::ground_goes_on(const Vec3& position_m) const {
  constexpr double slope = 1e-3;
  const Vec3 up(slope, 2.0 * slope, 1.0);
  return ground_is_hit(position_m, up) || ground_is_hit(position_m, -up);
}

std::vector<PlacementWatch::Shell> PlacementWatch::closed_shells(const DeviceState& of) const {
  std::vector<Shell> shells;
  for (const ShellAtPoint& at : simulator_.shells_at(of.position_m)) {
    const Shell shell{at.body, at.number};
    if (at.is_on_it || of.ignored_body == at.body || lets_through(shell) || facts_of(shell).is_foliage) continue;
    shells.push_back(shell);
  }
  return shells;
}

/// All shells of a body at once. A shell of foliage is of nothing else.
const PlacementWatch::ShellFacts& PlacementWatch::facts_of(const Shell& shell) const {
  const std::lock_guard lock(mutex_);
  const auto [entry, is_new] = shell_facts_.try_emplace(shell.first);
  std::vector<ShellFacts>& all = entry->second;
  if (!is_new) return all.at(shell.second);
  const Scene& scene = simulator_.scene();
  const auto [first, last] = scene.triangle_range(shell.first);
  for (std::uint32_t triangle = first; triangle < last; ++triangle) {
    const std::uint32_t number = scene.shell_of_triangle(triangle);
    if (number >= all.size()) all.resize(number + 1);
    const WorldFacet& facet = scene.facet(scene.facet_of_triangle(triangle));
    if (!all[number].material) all[number].material = facet.material;
    all[number].is_foliage = facet.is_foliage;
    all[number].transmits = all[number].transmits || facet.transmits;
  }
  return all.at(shell.second);
}

bool PlacementWatch::is_foliage(BodyId body) const {
  const Scene& scene = simulator_.scene();
  const auto [first, last] = scene.triangle_range(body);
  return first < last && scene.facet(scene.facet_of_triangle(first)).is_foliage;
}

bool PlacementWatch::lets_through(const Shell& shell) const {
  return simulator_.settings().propagation.max_transmissions > 0 && facts_of(shell).transmits;
}

/// As a person in a bus does.
bool PlacementWatch::moves_along(BodyId one, BodyId other) const {
  const Scene& scene = simulator_.scene();
  const Vec3& first_mps = scene.body_state(one).placement.velocity.linear_mps;
  return glm::length(first_mps - scene.body_state(other).placement.velocity.linear_mps) < moving_mps;
}

/// Of the receivers that are in no room but those of the transmitter, its `own`; 1 where there are none.
double PlacementWatch::share_of_receivers_in(const Shell& shell, const std::set<Shell>& own) const {
  std::size_t asked = 0, inside = 0;
  const auto ask = [&](const Vec3& point_m) {
    bool is_inside = false, is_elsewhere = false;
    for (const ShellAtPoint& at : simulator_.shells_at(point_m)) {
      is_inside = is_inside || Shell(at.body, at.number) == shell;
      const Shell other(at.body, at.number);
      is_elsewhere = is_elsewhere || (all_rooms_.contains(other) && !own.contains(other));
    }
    if (is_elsewhere && !is_inside) return;
    ++asked;
    inside += is_inside ? 1U : 0U;
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

/// The body or the material, and why nothing passes where nothing does.
std::string PlacementWatch::name_of(const Shell& shell) const {
  const Scene& scene = simulator_.scene();
  const bool all_block = simulator_.settings().propagation.max_transmissions == 0;
  const std::string why = all_block             ? ", which nothing may pass with max_transmissions 0"
                          : lets_through(shell) ? ""
                                                : ", which lets nothing through";
  if (shell.first.value != 0) return in_quotes(scene.body_name(shell.first)) + why;
  const std::optional<MaterialId> material = facts_of(shell).material;
  const std::string of = material ? " (of " + in_quotes(scene.material(*material).name) + ")" : "";
  return "a closed part of the scenery" + of + why;
}

/// All that was seen, in the order in which it was seen first.
std::vector<const PlacementWatch::Sighting*> PlacementWatch::sightings() const {
  std::vector<const Sighting*> all;
  for (const std::vector<Record>& of_kind : records_) {
    for (const Record& record : of_kind) {
      for (const Sighting& sighting : record.sightings()) all.push_back(&sighting);
    }
  }
  std::ranges::stable_sort(all, {}, [](const Sighting* sighting) { return sighting->frames.first(); });
  return all;
}

std::vector<std::string> PlacementWatch::warnings() const {
  constexpr std::size_t not_named = std::numeric_limits<std::size_t>::max();
  std::vector<Sighting> named;
  std::map<Problem, std::unordered_map<std::string_view, std::size_t>> subjects;  // … and which of `named` each is
  for (const Sighting* sighting : sightings()) {
    auto& alike = subjects[sighting->problem];
    const auto [subject, is_new] = alike.try_emplace(sighting->subject, not_named);
    if (is_new && alike.size() <= most_named) {
      subject->second = named.size();
      named.push_back(*sighting);
    } else if (subject->second != not_named) {
      named[subject->second].add(*sighting);
    }
  }
  std::vector<std::string> lines;
  for (const Sighting& sighting : named) {
    lines.push_back(file_ + ": " + sighting.subject + " " + sighting.detail + " (" + sighting.frames.words() + ")");
  }
  const std::map<Problem, const char*> words{
      {Problem::far_outside, "far outside the scenery"},       {Problem::under_ground, "under the ground"},
      {Problem::shut_in, "shut in without a transmitter"},     {Problem::shut_in_alone, "shut in without a receiver"},
      {Problem::drives_through, "inside of something"},        {Problem::goes_through, "led through walls"},
      {Problem::at_one_point, "at the point of a transmitter"}};
  for (const auto& [problem, alike] : subjects) {
    if (alike.size() <= most_named) continue;
    lines.push_back(file_ + ": " + std::to_string(alike.size() - most_named) + " more are " + words.at(problem));
  }
  return lines;
}

}  // namespace dcem::io
