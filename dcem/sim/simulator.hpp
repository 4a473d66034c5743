#pragma once
/// The whole line: scene and settings in, links out, frame by frame.
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dcem/channel/radio_map.hpp"
#include "dcem/field/path_contribution.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/frame_result.hpp"
#include "dcem/sim/search_plan.hpp"
#include "dcem/sim/settings.hpp"
#include "dcem/sim/shell_at_point.hpp"

namespace dcem {

class ThreadPool;
class WideIndex;

/// Owns the scene and the tree over it.
class Simulator {
 public:
  /// Throws std::invalid_argument where a setting is out of range or a material is not tabled at the frequency.
  Simulator(Scene scene, const SimulationSettings& settings);
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;

  const Scene& scene() const;
  const SimulationSettings& settings() const;
  Discovery discovery() const;     ///< exact or sampled: what is really done
  SearchPlan plan() const;         ///< how links and the points of maps are searched
  CacheMode cache() const;         ///< what is really remembered
  const WideIndex& index() const;  ///< over the scene's triangles (dcem/accel/wide_index.hpp)

  ThreadPool& pool() const;  ///< its threads, for what is done with a frame before the next one

  /// Moves the scene to a frame and solves all links, starting from what is remembered of the frame before.
  FrameResult advance(const Frame& frame);
  /// The same for the instant `time_s`, by the motions of the scene.
  FrameResult advance_to(double time_s, std::size_t index = 0);

  /// Takes the room of a frame that nobody needs any more: where links are many, the next frame begins with it.
  void give_back(FrameResult&& spent);

  /// Moves to a frame whose results are known already and took `spent`. What follows is as after `advance`; every
  /// counter included, too, where the cache is off. Throws std::logic_error where `cache()` is seed: what it remembers
  /// of a frame would be missing.
  TreeUpdateReport pass(const Frame& frame, const WorkCounters& spent);

  /// Links from all transmitters to receivers of the caller's, in the current frame, by transmitter, then receiver.
  /// `LinkResult::receiver` is the index in `receivers`. Nothing is remembered.
  std::vector<LinkResult> solve(std::span<const Device> receivers, WorkCounters* work = nullptr) const;
  /// Links between devices of the caller's, in the current frame: those that are asked for, each once, by transmitter,
  /// then receiver, between devices that are there. Each device is looked from once. Nothing is remembered. Throws
  /// std::invalid_argument where a number is none of a device.
  std::vector<LinkResult> solve(std::span<const Device> transmitters, std::span<const Device> receivers,
                                std::span<const LinkRequest> requests, WorkCounters* work = nullptr) const;

  /// About how many chains over edges a link of the first transmitter with a receiver of the caller's takes where
  /// discovery is sampled, by `max_interactions`: known before any is tried. Empty where there are none to try, or one
  /// of the two is absent. In the current frame.
  std::vector<double> estimated_chains(const Device& receiver) const;

  /// Closed shells that hold a point in the current frame or on which it lies, ascending.
  std::vector<ShellAtPoint> shells_at(const Vec3& point_m) const;

  /// Whether a device is there in the current frame.
  bool is_present(const Device& device) const;

  /// Moves scene and tree to a frame without solving anything.
  TreeUpdateReport move_to(const Frame& frame);
  /// One path on its own, in the current frame: over `sequence`, counted from the receiver, between a transmitter and a
  /// receiver of the scene. Nothing where there is no such path or an end is absent.
  std::optional<PathContribution> solve_path(std::size_t transmitter, std::size_t receiver,
                                             const Sequence& sequence) const;

  /// One map per transmitter over the grid, in the current frame. `progress(n)` is called from the working threads
  /// whenever n more points are done; where cells have several samples, these are the points. Points inside walls are
  /// counted along with those that take time.
  std::vector<RadioMap> radio_maps(const ReceiverGrid& grid, const std::function<void(std::size_t)>& progress = {},
                                   WorkCounters* work = nullptr) const;
  /// The same over a list, searched as links are: each point has what `solve` finds there, and none is left empty.
  std::vector<RadioMap> radio_maps(const ReceiverList& list, const std::function<void(std::size_t)>& progress = {},
                                   WorkCounters* work = nullptr) const;

 private:
  struct Body;
  std::unique_ptr<Body> body_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/sim/simulator_bodies.hpp"
#endif
