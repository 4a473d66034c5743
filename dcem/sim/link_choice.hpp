#pragma once
/// Which of all pairs of devices have a link, frame by frame, without looking at all pairs.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/scene/scene.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem {

/// Whether each receiver has links with all transmitters but itself, whatever their places.
bool takes_all_links(const Scene& scene, const LinkSettings& settings);

/// Of each receiver of a scene, the transmitters that it has links with: never the device that it is itself, of two
/// devices that both transmit and receive the one with the lesser id alone, and what the range and the pairs of
/// `LinkSettings` leave.
class LinkChoice {
 public:
  /// Throws std::invalid_argument where a pair names a device that is not there.
  LinkChoice(const Scene& scene, const LinkSettings& settings);

  /// Whether each receiver has links with all transmitters but itself, whatever their places.
  bool takes_all() const { return takes_all_; }

  /// Says where the transmitters are; an absent one has no links.
  void place(std::span<const std::optional<Vec3>> transmitters_m);

  /// The numbers of the transmitters that a receiver at `position_m` has links with, ascending.
  std::vector<std::uint32_t> transmitters_of(std::size_t receiver, const Vec3& position_m) const;

 private:
  using Cell = std::pair<std::int64_t, std::int64_t>;

  void resolve_pairs(const Scene& scene, const LinkSettings& settings);
  Cell cell_of(const Vec3& position_m) const;
  bool is_linked(std::uint32_t transmitter, std::size_t receiver, const Vec3& position_m) const;
  void add_cell(const Cell& cell, std::size_t receiver, const Vec3& position_m,
                std::vector<std::uint32_t>& chosen) const;

  std::optional<double> range_m_;
  bool takes_all_ = true;
  bool has_pairs_ = false;
  std::vector<std::vector<std::uint32_t>> pairs_;     ///< by receiver, where there are pairs
  std::vector<std::uint32_t> receiver_ranks_;         ///< of a transceiver its place by id, from 1; otherwise 0
  std::vector<std::uint32_t> transmitter_ranks_;      ///< the same
  std::vector<std::optional<std::uint32_t>> itself_;  ///< by receiver: the transmitter that is the same device
  std::vector<std::optional<Vec3>> transmitters_m_;
  std::vector<std::pair<Cell, std::uint32_t>> cells_;  ///< of transmitters that are there, ascending; with a range
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/sim/link_choice_bodies.hpp"
#endif
