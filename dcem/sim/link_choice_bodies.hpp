#pragma once
/// Bodies of link_choice.hpp.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/device_numbers.hpp"
#include "dcem/sim/link_choice.hpp"

namespace dcem {

namespace detail {

inline std::uint32_t number_of_end(const std::unordered_map<std::string, std::uint32_t>& numbers, const std::string& id,
                                   const std::string& kind) {
  const auto found = numbers.find(id);
  if (found == numbers.end()) throw std::invalid_argument("links: pairs: there is no " + kind + " '" + id + "'");
  return found->second;
}

/// Of each transceiver its place among them by id, from 1.
inline std::vector<std::uint32_t> transceiver_ranks(std::span<const Device> devices) {
  std::vector<std::uint32_t> order;
  for (std::size_t index = 0; index < devices.size(); ++index) {
    if (devices[index].is_transceiver) order.push_back(static_cast<std::uint32_t>(index));
  }
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t one, std::uint32_t other) { return devices[one].id < devices[other].id; });
  std::vector<std::uint32_t> ranks(devices.size(), 0);
  for (std::size_t rank = 0; rank < order.size(); ++rank) ranks[order[rank]] = static_cast<std::uint32_t>(rank + 1);
  return ranks;
}

}  // namespace detail

DCEM_INLINE bool takes_all_links(const Scene& scene, const LinkSettings& settings) {
  const std::span<const Device> receivers = scene.receivers();
  return !settings.range_m && !settings.pairs && !settings.receivers &&
         std::none_of(receivers.begin(), receivers.end(), [](const Device& device) { return device.is_transceiver; });
}

DCEM_INLINE LinkChoice::LinkChoice(const Scene& scene, const LinkSettings& settings)
    : range_m_(settings.range_m),
      takes_all_(takes_all_links(scene, settings)),
      has_pairs_(settings.pairs.has_value()),
      receiver_ranks_(detail::transceiver_ranks(scene.receivers())),
      transmitter_ranks_(detail::transceiver_ranks(scene.transmitters())) {
  const auto transmitters = detail::numbers_by_id(scene.transmitters());
  for (const Device& receiver : scene.receivers()) {
    const auto same = transmitters.find(receiver.id);
    itself_.push_back(same == transmitters.end() ? std::nullopt : std::optional(same->second));
  }
  if (has_pairs_) resolve_pairs(scene, settings);
}

DCEM_INLINE void LinkChoice::resolve_pairs(const Scene& scene, const LinkSettings& settings) {
  const auto transmitters = detail::numbers_by_id(scene.transmitters());
  const auto receivers = detail::numbers_by_id(scene.receivers());
  const auto is_transceiver = [&](const std::string& id) {
    const auto found = transmitters.find(id);
    return found != transmitters.end() && scene.transmitters()[found->second].is_transceiver;
  };
  pairs_.resize(scene.receivers().size());
  for (const auto& [one, other] : *settings.pairs) {
    const bool swapped = is_transceiver(one) && is_transceiver(other) && other < one;
    const std::uint32_t from = detail::number_of_end(transmitters, swapped ? other : one, "transmitter");
    pairs_[detail::number_of_end(receivers, swapped ? one : other, "receiver")].push_back(from);
  }
  for (std::vector<std::uint32_t>& of_one : pairs_) {
    std::sort(of_one.begin(), of_one.end());
    of_one.erase(std::unique(of_one.begin(), of_one.end()), of_one.end());
  }
}

DCEM_INLINE LinkChoice::Cell LinkChoice::cell_of(const Vec3& position_m) const {
  // A little larger than the range: rounding must not put ends that are in range two cells apart. Places are within
  // 1e9 m and ranges at least 1e-3 m: no overflow.
  const double width_m = *range_m_ * (1.0 + 1e-9);
  return {static_cast<std::int64_t>(std::floor(position_m.x / width_m)),
          static_cast<std::int64_t>(std::floor(position_m.y / width_m))};
}

DCEM_INLINE void LinkChoice::place(std::span<const std::optional<Vec3>> transmitters_m) {
  transmitters_m_.assign(transmitters_m.begin(), transmitters_m.end());
  if (!range_m_ || has_pairs_) return;
  // Most are in the cell in which they were: only the others are sorted.
  std::vector<char> stays(transmitters_m_.size(), 0);
  std::erase_if(cells_, [&](const std::pair<Cell, std::uint32_t>& entry) {
    const auto& [cell, index] = entry;
    if (index >= stays.size() || !transmitters_m_[index] || cell_of(*transmitters_m_[index]) != cell) return true;
    stays[index] = 1;
    return false;
  });
  const auto kept = static_cast<std::ptrdiff_t>(cells_.size());
  for (std::size_t index = 0; index < transmitters_m_.size(); ++index) {
    if (stays[index] != 0 || !transmitters_m_[index]) continue;
    cells_.emplace_back(cell_of(*transmitters_m_[index]), static_cast<std::uint32_t>(index));
  }
  std::sort(cells_.begin() + kept, cells_.end());
  std::inplace_merge(cells_.begin(), cells_.begin() + kept, cells_.end());
}

DCEM_INLINE bool LinkChoice::is_linked(std::uint32_t transmitter, std::size_t receiver, const Vec3& position_m) const {
  const std::optional<Vec3>& place_m = transmitters_m_[transmitter];
  if (!place_m || itself_[receiver] == transmitter) return false;
  const std::uint32_t from = transmitter_ranks_[transmitter], to = receiver_ranks_[receiver];
  if (from > 0 && to > 0 && from > to) return false;
  return !range_m_ || glm::length(*place_m - position_m) <= *range_m_;
}

DCEM_INLINE void LinkChoice::add_cell(const Cell& cell, std::size_t receiver, const Vec3& position_m,
                                      std::vector<std::uint32_t>& chosen) const {
  for (auto entry = std::lower_bound(cells_.begin(), cells_.end(), std::pair(cell, std::uint32_t{0}));
       entry != cells_.end() && entry->first == cell; ++entry) {
    if (is_linked(entry->second, receiver, position_m)) chosen.push_back(entry->second);
  }
}

DCEM_INLINE std::vector<std::uint32_t> LinkChoice::transmitters_of(std::size_t receiver, const Vec3& position_m) const {
  std::vector<std::uint32_t> chosen;
  const auto add = [&](std::uint32_t transmitter) {
    if (is_linked(transmitter, receiver, position_m)) chosen.push_back(transmitter);
  };
  if (has_pairs_) {
    for (const std::uint32_t transmitter : pairs_[receiver]) add(transmitter);
  } else if (range_m_) {
    const Cell middle = cell_of(position_m);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        add_cell({middle.first + x, middle.second + y}, receiver, position_m, chosen);
      }
    }
    std::sort(chosen.begin(), chosen.end());
  } else {
    for (std::uint32_t transmitter = 0; transmitter < transmitters_m_.size(); ++transmitter) add(transmitter);
  }
  return chosen;
}

}  // namespace dcem
