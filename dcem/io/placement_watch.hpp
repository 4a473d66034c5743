#pragma once
/// Devices, grids and vehicles in places where they can hardly be meant to be: kilometres outside the scenery, under
/// the ground, inside what lets nothing through, both ends of a link at one point. What is far away but as high as
/// aeroplanes and satellites are is meant, as long as another device is near the scenery. A watch looks at each frame
/// and says at the end what it saw, once for all frames. It knows the scenery and guesses at what is meant: a warning
/// is no error.
#include <array>
#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dcem/scene/device.hpp"
#include "dcem/sim/simulator.hpp"

namespace dcem::io {

class PlacementWatch {
 public:
  /// Whose links are looked at: those that the simulator's settings choose, or, as maps have them, all there are.
  enum class Links { chosen, all };

  /// Watches a simulator, its transmitters and objects, these receivers and these grids. `file` begins each warning.
  /// Everything must outlive the watch.
  PlacementWatch(std::string file, const Simulator& simulator, std::span<const Device> receivers,
                 std::span<const ReceiverGrid> grids, Links links = Links::chosen);
  ~PlacementWatch();
  PlacementWatch(const PlacementWatch&) = delete;
  PlacementWatch& operator=(const PlacementWatch&) = delete;

  /// Looks at the simulator's current frame. Some microseconds for each device and each object.
  void look(const Frame& frame);

  /// One line for each kind of misplacement of each device, grid or object, with the frames and the likely cause; of
  /// each kind the first five, and how many more there are.
  std::vector<std::string> warnings() const;

 private:
  using Shell = std::pair<BodyId, std::uint32_t>;  ///< its number within the body is counted from 1
  struct ShellFacts {
    std::optional<MaterialId> material;  ///< of one of its facets
    bool is_foliage = false;
    bool transmits = false;  ///< somewhere
  };
  enum class Kind { transmitter, receiver, grid, object };
  static constexpr std::size_t kinds = 4;
  enum class Problem { far_outside, under_ground, shut_in, shut_in_alone, drives_through, goes_through, at_one_point };
  struct Sighting;
  class Record;

  /// Calls `look(index)` on all threads.
  template <typename Look>
  void for_each(std::size_t count, Look&& look) const;
  void note_rooms();
  void look_at(Kind kind, std::size_t number, Record& record);
  void look_at_place(const Vec3& position_m, const std::string& subject, Record& record) const;
  void look_at_receiver(const Device& device, Record& record) const;
  void look_at_transmitter(std::size_t number, Record& record) const;
  void look_for_twin(const Device& device, const Vec3& position_m, const std::string& subject, Record& record) const;
  void look_at_grid(const ReceiverGrid& grid, Record& record) const;
  void look_at_object(BodyId body, Record& record);
  void look_at_way(BodyId body, const Vec3& middle_m, const std::string& subject, Record& record);
  bool anyone_is_near() const;
  bool is_linked(const Device& transmitter, const Device& receiver) const;
  bool is_far(const Vec3& position_m, const std::string& subject, Record& record) const;
  bool is_under_ground(const Vec3& position_m) const;
  bool ground_is_hit(const Vec3& from_m, const Vec3& direction) const;
  bool wall_is_near(const Vec3& from_m, const Vec3& aside) const;
  bool ground_goes_on(const Vec3& position_m) const;
  /// Shells around a device that let nothing through, but those of what it rides on or is mounted on.
  std::vector<Shell> closed_shells(const DeviceState& of) const;
  const ShellFacts& facts_of(const Shell& shell) const;
  bool lets_through(const Shell& shell) const;
  bool is_foliage(BodyId body) const;
  bool moves_along(BodyId one, BodyId other) const;
  double share_of_receivers_in(const Shell& shell, const std::set<Shell>& own) const;
  std::string name_of(const Shell& shell) const;
  std::vector<const Sighting*> sightings() const;

  std::string file_;
  const Simulator& simulator_;
  std::span<const Device> receivers_;
  std::span<const ReceiverGrid> grids_;
  Links links_;
  Aabb<double> box_;                                 ///< of the scenery
  std::vector<std::optional<Vec3>> middles_m_;       ///< of all bodies, in their own coordinates
  const Frame* frame_ = nullptr;                     ///< while it is looked at
  std::vector<std::optional<Vec3>> transmitters_m_;  ///< of those that are there
  bool may_fly_ = true;                              ///< someone is near the scenery, for others to fly
  std::vector<std::vector<Shell>> rooms_;            ///< by transmitter: shells that hold it or carry it …
  std::set<Shell> all_rooms_;                        ///< … and those of all
  /// By body: the houses that waves pass around it in the frame before; absent where it was not there.
  std::vector<std::optional<std::vector<Shell>>> houses_before_;
  mutable std::mutex mutex_;                                       ///< of `shell_facts_`
  mutable std::map<BodyId, std::vector<ShellFacts>> shell_facts_;  ///< by number, from 1
  std::array<std::vector<Record>, kinds> records_;                 ///< by kind and index
};

}  // namespace dcem::io
