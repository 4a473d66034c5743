#pragma once
/// Bodies of transmitter_ends.hpp.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/sim/detail/transmitter_ends.hpp"

namespace dcem::detail {

DCEM_INLINE TransmitterEnds TransmitterEnds::only(std::vector<std::uint32_t> chosen) const {
  TransmitterEnds some;
  some.devices = devices;
  some.link.reserve(chosen.size());
  some.reached.reserve(chosen.size());
  for (const std::uint32_t index : chosen) {
    some.link.push_back(link[index]);
    some.reached.push_back(reached[index]);
    if (!halves.empty()) some.halves.add(halves[index]);
    if (!surfaces.empty()) some.surfaces.push_back(surfaces[index]);
  }
  some.limits = limits;
  some.contacts = contacts;
  some.numbers = std::move(chosen);
  some.all = this;
  return some;
}

DCEM_INLINE std::optional<std::uint32_t> TransmitterEnds::same_as(const std::string& receiver,
                                                                  const LinkEnd& end) const {
  if (by_id == nullptr) return std::nullopt;
  const auto found = by_id->find(receiver);
  if (found == by_id->end() || !link[found->second] || !same_bits(link[found->second], end)) return std::nullopt;
  return found->second;
}

DCEM_INLINE const KeptHalf* TransmitterEnds::half_of(const std::string& receiver, const LinkEnd& end,
                                                     bool with_lists) const {
  if (all != nullptr) return all->half_of(receiver, end, with_lists);
  const std::optional<std::uint32_t> number = halves.empty() ? std::nullopt : same_as(receiver, end);
  if (!number) return nullptr;
  const KeptHalf& half = halves[*number];
  return half.is_of_frame() && (!with_lists || half.lists() != nullptr) ? &half : nullptr;
}

DCEM_INLINE std::shared_ptr<const SurfaceView> TransmitterEnds::view_of(const std::string& receiver,
                                                                        const LinkEnd& end) const {
  if (all != nullptr) return all->view_of(receiver, end);
  const std::optional<std::uint32_t> number = surfaces.empty() ? std::nullopt : same_as(receiver, end);
  if (!number) return nullptr;
  return {surfaces[*number], &surfaces[*number]->view};
}

}  // namespace dcem::detail
