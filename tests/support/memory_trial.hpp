#pragma once
/// What is remembered from frame to frame, held against solving each frame from scratch.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/sim/simulator.hpp"
#include "dcem/sim/verify/same_bits.hpp"
#include "tests/support/law_scenes.hpp"

namespace dcem::test {

/// Orders of a search.
struct MemoryOrders {
  int reflections = 2, transmissions = 0, diffractions = 1, interactions = 2;
  bool free_edges = false;
};

inline SimulationSettings memory_settings(const MemoryOrders& orders) {
  SimulationSettings settings;
  settings.frequency_hz = 5e9;
  settings.threads = 1;
  PropagationSettings& propagation = settings.propagation;
  propagation.max_reflections = orders.reflections;
  propagation.max_transmissions = orders.transmissions;
  propagation.max_diffractions = orders.diffractions;
  propagation.max_interactions = orders.interactions;
  propagation.diffraction.free_edges = orders.free_edges;
  settings.expected_frames = 1'000'000;  // lists of masts are made in the first of them
  return settings;
}

inline SimulationSettings with_cache(SimulationSettings settings, CacheMode cache) {
  settings.propagation.cache = cache;
  return settings;
}

/// All that a frame says of its links, as bytes.
inline std::string bits(const Scene& scene, const std::vector<LinkResult>& links) {
  std::string bytes;
  for (const LinkResult& link : links) {
    bytes += bits(scene, link) + std::to_string(link.receiver);
    append_bits(bytes, {link.diffuse.power_ratio});
    for (const PathContribution& path : link.paths) {
      for (const FoliageLength& foliage : path.path.foliage) append_bits(bytes, {foliage.length_m});
      for (std::size_t row = 0; row < path.channel.rows(); ++row) {
        for (std::size_t column = 0; column < path.channel.columns(); ++column) {
          append_bits(bytes, {path.channel(row, column).real(), path.channel(row, column).imag()});
        }
      }
    }
  }
  return bytes;
}

/// What some frames came to.
struct MemoryTally {
  std::size_t frames = 0, links = 0, paths = 0, different = 0;
  std::uint64_t taken_over = 0;
  /// Sequences solved and legs looked along, with what is remembered, and where that is forgotten.
  std::uint64_t work = 0, work_anew = 0;

  MemoryTally& operator+=(const MemoryTally& other) {
    frames += other.frames;
    links += other.links;
    paths += other.paths;
    different += other.different;
    taken_over += other.taken_over;
    work += other.work;
    work_anew += other.work_anew;
    return *this;
  }
};

/// Follows what random numbers from 1 on make, and checks that memory changed no bit of many paths and spared a tenth
/// of the work at least.
template <typename Follow>
void check_drives(std::uint64_t count, Follow&& follow) {
  MemoryTally sum;
  for (std::uint64_t seed = 1; seed <= count; ++seed) sum += follow(seed);
  MESSAGE(sum.frames << " frames, " << sum.paths << " paths, " << sum.different << " different, work " << sum.work
                     << " of " << sum.work_anew);
  CHECK(sum.different == 0);
  CHECK(sum.paths > 10'000);
  CHECK(10 * sum.work < 9 * sum.work_anew);  // places were gone through
}

inline std::uint64_t work_of(const FrameResult& frame) {
  return frame.work.sequences_solved + frame.work.legs;
}

/// One scene led through the same frames several times: with memory; without, where a small scene is searched by trying
/// all sequences; and, where that is asked for, with memory that is lost before each frame.
class MemoryTrial {
 public:
  MemoryTrial(const Scene& scene, const SimulationSettings& settings, bool forgets = true)
      : scene_(scene),
        own_(scene, with_cache(settings, CacheMode::exact)),
        from_scratch_(scene, with_cache(settings, CacheMode::off)) {
    if (forgets) forgetful_.emplace(scene, with_cache(settings, CacheMode::exact));
  }

  const Scene& scene() const { return scene_; }
  const MemoryTally& tally() const { return tally_; }
  /// The one with memory: what is done to it beside `advance` must change nothing.
  Simulator& own() { return own_; }

  /// Goes to a frame, and checks every link in it. Returns what all agree on.
  FrameResult advance(const Frame& frame) {
    const FrameResult own = own_.advance(frame);
    FrameResult expected = from_scratch_.advance(frame);
    scene_.apply(frame);
    ++tally_.frames;
    tally_.links += expected.links.size();
    tally_.taken_over += own.cache.taken_over;
    tally_.work += work_of(own);
    for (const LinkResult& link : expected.links) tally_.paths += link.paths.size();
    const std::string bytes = bits(scene_, expected.links);
    check(frame, "remembered", own, expected, bytes);
    if (!forgetful_) return expected;
    forgetful_->move_to(frame);
    const FrameResult anew = forgetful_->advance(frame);
    tally_.work_anew += work_of(anew);
    check(frame, "forgotten", anew, expected, bytes);
    return expected;
  }
  FrameResult advance_to(double time_s, std::size_t index = 0) { return advance(scene_.frame_at(time_s, index)); }
  /// Whether something was remembered, and spared work.
  bool has_remembered() const { return tally_.work < tally_.work_anew; }
  /// Frames 0, 1, 2 … of a second each.
  void follow(std::size_t frames, double step_s = 1.0) {
    for (std::size_t index = 0; index < frames; ++index) advance_to(step_s * static_cast<double>(index), index);
  }

 private:
  void check(const Frame& frame, const char* which, const FrameResult& own, const FrameResult& expected,
             const std::string& bytes) {
    if (bits(scene_, own.links) == bytes) return;
    ++tally_.different;
    for (std::size_t at = 0; at < own.links.size() && at < expected.links.size(); ++at) {
      const LinkResult &one = own.links[at], &other = expected.links[at];
      if (bits(scene_, one) == bits(scene_, other)) continue;
      FAIL_CHECK(std::string(which) << ", frame " << frame.index << " at " << frame.time_s << " s, link "
                                    << scene_.transmitters()[one.transmitter].id << " to "
                                    << scene_.receivers()[one.receiver].id << ": " << names(one) << "expected"
                                    << names(other));
      return;
    }
    FAIL_CHECK(std::string(which) << ", frame " << frame.index << ": other links");
  }
  std::string names(const LinkResult& link) const {
    std::string all = std::to_string(link.paths.size()) + " paths ";
    for (const PathContribution& path : link.paths) all += path_id(scene_, path.path) + " ";
    return all;
  }

  Scene scene_;
  Simulator own_, from_scratch_;
  std::optional<Simulator> forgetful_;
  MemoryTally tally_;
};

/// A device on a way of its own.
inline Device moving_device(const std::string& id, const Motion& motion, double power_dbm = 30.0) {
  Device device = device_at(id, Vec3(0.0), power_dbm);
  device.motion = motion;
  return device;
}
inline Device riding_device(const std::string& id, const std::string& object, const Vec3& offset_m,
                            bool sees_own_body = false) {
  Device device = device_at(id, Vec3(0.0), 20.0);
  device.attachment = Attachment{object, offset_m, sees_own_body};
  return device;
}

/// A waypoint a second.
inline WaypointMotion way_over(const std::vector<Pose>& poses) {
  WaypointMotion motion;
  for (const Pose& pose : poses) motion.waypoints.push_back({static_cast<double>(motion.waypoints.size()), pose});
  return motion;
}
/// `pose_at(index)` for so many seconds.
template <typename PoseAt>
WaypointMotion way_of(std::size_t count, PoseAt&& pose_at) {
  std::vector<Pose> poses;
  for (std::size_t index = 0; index < count; ++index) poses.push_back(pose_at(static_cast<double>(index)));
  return way_over(poses);
}
/// From one place to another in equal steps.
inline WaypointMotion straight_way(std::size_t count, const Vec3& from_m, const Vec3& to_m) {
  const double steps = static_cast<double>(count) - 1.0;
  return way_of(count, [&](double at) { return Pose{from_m + at / steps * (to_m - from_m), 0, 0, 0}; });
}

}  // namespace dcem::test
