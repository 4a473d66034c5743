#pragma once
/// The simulator of simulator.hpp, for any model of surfaces and any index over triangles.
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "dcem/accel/spatial_index.hpp"
#include "dcem/accel/wide_index.hpp"
#include "dcem/channel/radio_map.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/field/field_evaluator.hpp"
#include "dcem/field/medium_loss.hpp"
#include "dcem/paths/halves/driven_ways.hpp"
#include "dcem/paths/lifetime/facet_rims.hpp"
#include "dcem/paths/path_finder.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/detail/frame_change.hpp"
#include "dcem/sim/detail/link_work.hpp"
#include "dcem/sim/detail/material_table_of.hpp"
#include "dcem/sim/detail/receiver_memory.hpp"
#include "dcem/sim/detail/transmitter_ends.hpp"
#include "dcem/sim/discovery.hpp"
#include "dcem/sim/frame_result.hpp"
#include "dcem/sim/link_choice.hpp"
#include "dcem/sim/settings.hpp"
#include "dcem/sim/shell_at_point.hpp"

namespace dcem {

/// Owns the scene and the index over it. `Surface` says how all surfaces reflect and transmit: the scene's materials,
/// or a model of the caller's own. `Index` is `WideIndex`, or one of those made of a `BoxIndex` to check it.
template <SurfaceModel Surface = MaterialTable, SpatialIndex Index = WideIndex>
class BasicSimulator {
 public:
  /// Throws std::invalid_argument where a setting is out of range.
  BasicSimulator(Scene scene, SimulationSettings settings, Surface surface);
  /// With the scene's own materials. Throws std::invalid_argument also where one is not tabled at the frequency.
  BasicSimulator(const Scene& scene, const SimulationSettings& settings) requires std::same_as<Surface, MaterialTable>
      : BasicSimulator(scene, settings, detail::material_table_of(scene, settings)) {}

  const Scene& scene() const { return scene_; }
  const SimulationSettings& settings() const { return settings_; }
  ThreadPool& pool() const { return *pool_; }
  const Index& index() const { return index_; }
  const Surface& surface() const { return surface_; }
  Discovery discovery() const { return plan_.discovery; }  ///< exact or sampled: what is really done
  const SearchPlan& plan() const { return plan_; }         ///< how links and the points of maps are searched
  CacheMode cache() const { return cache_; }               ///< what is really remembered

  /// Moves the scene to a frame and solves all links, starting from what is remembered of the frame before.
  FrameResult advance(const Frame& frame);
  /// The same for the instant `time_s`, by the motions of the scene.
  FrameResult advance_to(double time_s, std::size_t index = 0) { return advance(scene_.frame_at(time_s, index)); }
  /// Takes the room of a frame that nobody needs any more: where links are many, the next frame begins with it.
  void give_back(FrameResult&& spent) { room_ = detail::room_of(std::move(spent.links), *pool_); }

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

  /// Closed shells that hold a point in the current frame or on which it lies, ascending.
  std::vector<ShellAtPoint> shells_at(const Vec3& point_m) const;
  /// Whether a device is there in the current frame.
  bool is_present(const Device& device) const { return state_of(device).present; }
  /// Moves scene and index to a frame without solving anything.
  TreeUpdateReport move_to(const Frame& frame);
  /// As `Simulator` has it.
  std::vector<double> estimated_chains(const Device& receiver) const;
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
  using Tracer = SceneTracer<Index>;
  using Evaluator = FieldEvaluator<Surface, AnyPathLoss>;

  using TransmitterEnds = detail::TransmitterEnds;
  using DeviceEnd = detail::DeviceEnd;
  using LinkSlots = detail::LinkSlots;
  using Solved = detail::Solved;
  using Spent = detail::Spent;
  using LinkListsOfAll = std::vector<std::vector<std::uint32_t>>;
  struct Following;
  struct FollowedLink;
  /// A link that is to be solved: its transmitter among those of the receiver, its place among the results, whether
  /// both ends are where they were, and whether its fields are then what they were, too.
  struct LinkToFollow {
    std::size_t transmitter, place;
    bool rests, fields_stay;
  };
  struct MapShare;
  struct MapOrder;
  std::vector<RadioMap> solve_map(const MapOrder& order, const std::function<void(std::size_t)>& progress,
                                  WorkCounters* work) const;

  void check_surface_model() const;
  TreeUpdateReport update_index(const ChangeSet& changes);
  void note_rays(const WorkCounters& work) {
    index_.note_rays({work.nodes_visited, work.primitives_tested}, work.rays + work.legs);
  }
  LinkEnd link_end(const DeviceState& state, TraversalCounters& counters) const {
    return make_link_end(Tracer(scene_, index_), state.position_m, state.ignored_body, counters);
  }
  void forget_replaced(const ChangeSet& changes, CacheCounters& counters);
  DeviceState state_of(const Device& device) const { return scene_.device_state_now(device, frame_.time_s); }
  /// Chooses the links of the frame, where not every receiver has one with every transmitter.
  void choose_links();
  /// `is_of_frame`: the receivers are those of the scene, with the links that were chosen.
  Solved solve_all(std::span<const Device> receivers, const TransmitterEnds& transmitters, std::span<PathCache> caches,
                   bool is_of_frame) const;
  /// Devices as so many receivers need them. With `reach`, which has an entry per transmitter, edges that were within
  /// reach in frames before count, too. `contacts`: what is known. With `halves`, which has an entry per transmitter
  /// too, what is kept of them is brought up to date; without, what is kept is used where it is that of the frame, and
  /// otherwise they are made, `fine` where very many receivers join them.
  TransmitterEnds transmitter_ends(std::span<const Device> devices, std::size_t receivers,
                                   std::span<EdgeReach> reach = {}, std::span<KeptHalf> halves = {},
                                   SceneContacts contacts = {}, bool fine = false) const;
  void find_transmitter_reach(TransmitterEnds& ends, std::span<EdgeReach> reach) const;
  void find_transmitter_halves(TransmitterEnds& ends, std::size_t receivers, std::span<KeptHalf> halves,
                               bool fine) const;
  void look_at_surfaces(TransmitterEnds& ends) const;
  /// Whether views of the scene are made, from either end.
  bool looks() const { return plan_.joined > 0 || settings_.propagation.diffuse.enabled; }
  /// Room for what receivers see, one per thread; empty where no views are made.
  std::vector<ReceiverRoom> receiver_rooms() const {
    if (!looks()) return {};
    const int pixels = detail::pixels_for_facets(PathHalf::default_pixels, outlines_->size());
    return std::vector<ReceiverRoom>(std::max(1U, pool_->size()), ReceiverRoom{PathHalf(pixels), {}});
  }
  Evaluator evaluator() const {
    const PropagationSettings& propagation = settings_.propagation;
    return Evaluator(scene_, surface_, propagation.path_loss, settings_.frequency_hz,
                     {propagation.diffraction.lossy_wedge, propagation.max_transmissions}, medium_);
  }
  PathSearchSettings search_settings(const KnownContacts& known = {}) const;
  std::span<const std::optional<LinkEnd>> ends_beside(const Device& receiver, const TransmitterEnds& transmitters,
                                                      std::vector<std::optional<LinkEnd>>& others) const;
  /// Where a receiver's sequences of few interactions come from, where the plan has halves: they are joined in a room,
  /// or have been already.
  struct Proposals {
    ReceiverRoom* room = nullptr;
    std::span<const SequenceList> joined{};
  };
  struct ReceiverSearch;

  /// By receiver, the transmitters that are there and not the same device; none of one that is away.
  LinkListsOfAll all_links(std::span<const Device> receivers, const TransmitterEnds& transmitters) const;
  /// The links of one receiver, one per transmitter that is present, at their places; none where it is absent.
  Spent solve_receiver(const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, PathCache* cache,
                       const Proposals& proposals, const LinkSlots& links) const;
  /// The same for a receiver by itself.
  Solved solve_alone(const Device& receiver, std::size_t index, const TransmitterEnds& transmitters,
                     const Proposals& proposals) const;
  /// What a receiver sees of surfaces, where diffuse power is asked for.
  std::shared_ptr<const SurfaceView> surfaces_seen_from(const Device& receiver, const LinkEnd& end,
                                                        const TransmitterEnds& transmitters, ReceiverRoom* room) const;
  /// What rough surfaces bring from a transmitter to a receiver with this view; nothing where it is not asked for.
  DiffusePower diffuse_power(const Device& receiver, const DeviceEnd& end, const SurfaceView* view,
                             const TransmitterEnds& transmitters, std::size_t transmitter, WorkCounters& work) const;
  /// `room`: paths that nobody needs any more.
  LinkResult make_link(LinkPaths&& found, DiffusePower&& diffuse, std::size_t transmitter, const DeviceEnd& from,
                       const DeviceEnd& to, const Evaluator& evaluator, std::vector<PathContribution>&& room) const;
  /// A link from all its paths, in any order, some of them more than once.
  LinkResult finish_link(std::vector<PathContribution>&& paths, DiffusePower&& diffuse, std::size_t transmitter,
                         const DeviceEnd& from, const DeviceEnd& to, const Evaluator& evaluator) const;

  /// The links of all receivers of the scene, from what is remembered of the frame before …
  Solved follow_all(const TransmitterEnds& transmitters);
  /// … and those of one; `transmitters` are those that it has links with.
  Spent follow_receiver(const Device& receiver, std::size_t index, const TransmitterEnds& transmitters,
                        ReceiverRoom* room, const LinkSlots& links);
  Spent follow_links(const Following& following, detail::ReceiverMemory& memory, std::span<const LinkToFollow> wanted,
                     const LinkSlots& links) const;
  LinkResult follow_link(FollowedLink& link, const KeptHalf& half, bool fields_stay) const;
  void check_some(const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, ReceiverRoom* room,
                  const LinkSlots& links) const;
  bool has_plain_links() const;
  Spent solve_again(const Device& receiver, std::size_t index, const TransmitterEnds& transmitters, ReceiverRoom* room,
                    const LinkSlots& links);
  void look_from_receiver(Following& following, detail::ReceiverMemory& memory, ReceiverRoom& room, bool stands) const;
  void look_anew(Following& following, ReceiverRoom& room) const;
  void look_for_triples(Following& following, detail::ReceiverMemory& memory, ReceiverRoom& room, bool stands) const;
  std::vector<PathContribution> paths_of_moving(FollowedLink& link, const KeptHalf& half) const;
  bool joins_anew(const Following& following, const detail::ReceiverMemory& memory, const LinkToFollow& link) const;
  bool all_rest(const TransmitterEnds& transmitters) const;
  bool some_rest(const TransmitterEnds& transmitters) const;
  bool may_pool(const Following& following, const KeptHalf& half, std::size_t transmitter, bool rests) const;
  void prepare_pool(FollowedLink& link, const KeptHalf& half) const;
  std::vector<PathContribution> paths_in_place(FollowedLink& link, const KeptHalf& half) const;
  std::vector<PathContribution> paths_of_standing(FollowedLink& link, bool fields_stay) const;
  std::optional<PathContribution> note_standing(FollowedLink& link, const Sequence& sequence) const;
  bool finds_lifetimes() const;
  void find_lifetimes(std::vector<LinkResult>& links, const TransmitterEnds& transmitters);
  PoolSource pool_source(const FollowedLink& link) const;
  void note_places();
  void note_ways();
  void note_transmitters(const TransmitterEnds& ends);
  void choose_remembered(std::size_t walking);
  std::size_t receivers_on_the_move() const;
  bool is_on_the_move(std::size_t receiver) const;
  ListPace pace_of_lists(std::size_t walking) const;
  /// Where it is asked for, gives the paths of a link a channel with a path of its own for each pair of elements.
  void trace_elements(std::span<PathContribution> paths, const DeviceEnd& from, const DeviceEnd& to,
                      const Evaluator& evaluator) const;

  Scene scene_;
  SimulationSettings settings_;
  Surface surface_;
  Index index_;
  MediumLoss medium_;
  SearchPlan plan_;
  CacheMode cache_;
  LinkChoice choice_;
  std::shared_ptr<const detail::DeviceNumbers> numbers_;  ///< of the scene's transmitters
  LinkListsOfAll chosen_;                          ///< by receiver of the scene, where not all have links with all …
  std::vector<std::size_t> links_of_;              ///< … and how many links each transmitter has
  std::vector<std::uint32_t> moved_;               ///< triangles that the index has still to hear of
  std::vector<PathCache> caches_;                  ///< one per receiver of the scene; none where the cache is off
  std::vector<EdgeReach> reach_;                   ///< one per transmitter; none where the cache is off
  std::optional<FacetOutlines> outlines_;          ///< where views are made
  std::unique_ptr<LaneScene> lanes_;               ///< where the plan has halves; those that are kept point to it
  std::vector<KeptHalf> halves_;                   ///< one per transmitter, where the plan has them …
  bool halves_are_current_ = false;                ///< … and whether they are those of the current frame
  std::size_t frames_done_ = 0;                    ///< of those that are expected
  ListPace pace_;                                  ///< of what transmitters that stand list of the scenery
  std::optional<detail::FrameChange> change_;      ///< since the frame before, where the cache is exact; so the next
  std::vector<detail::ReceiverMemory> receivers_;  ///< one per receiver of the scene …
  std::vector<char> is_remembered_;                ///< … and whether it is remembered what it sees, in this frame
  /// That devices have come into, and what may carry a path there; those that are followed point to the places.
  std::unique_ptr<KnownPlaces> known_places_ = std::make_unique<KnownPlaces>();
  KnownPools known_pools_;
  DrivenWays driven_ways_;  ///< of receivers, where sequences of three elements are joined
  std::size_t most_known_places_ = 0;
  std::vector<std::optional<LinkEnd>> transmitters_before_;
  std::vector<std::optional<DeviceState>> transmitter_states_before_;
  std::optional<FacetRims> rims_;                              ///< where lifetimes are asked for
  std::vector<char> transmitter_rests_, transmitter_is_same_;  ///< as in the frame before: its place; all of it
  Frame frame_;
  std::vector<LinkResult> room_;      ///< of a frame that has been given back
  std::unique_ptr<ThreadPool> pool_;  ///< of all work on frames and maps
};

}  // namespace dcem

#include "dcem/sim/detail/simulator_ends.hpp"
#include "dcem/sim/detail/simulator_frames.hpp"
#include "dcem/sim/detail/simulator_lifetime.hpp"
#include "dcem/sim/detail/simulator_links.hpp"
#include "dcem/sim/detail/simulator_maps.hpp"
#include "dcem/sim/detail/simulator_memory.hpp"
#include "dcem/sim/detail/simulator_moving.hpp"
#include "dcem/sim/detail/simulator_search.hpp"
#include "dcem/sim/detail/simulator_setup.hpp"
#include "dcem/sim/detail/simulator_standing.hpp"

#if defined(DCEM_ENGINE)
extern template class dcem::BasicSimulator<dcem::MaterialTable, dcem::WideIndex>;
#endif
