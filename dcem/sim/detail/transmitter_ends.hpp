#pragma once
/// The transmitters of a frame, as the paths and the fields of links need them.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dcem/field/diffuse/scattering_limits.hpp"
#include "dcem/field/radio_end.hpp"
#include "dcem/paths/halves/link_halves.hpp"
#include "dcem/paths/query/scene_contacts.hpp"
#include "dcem/paths/visible/surface_view.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/detail/device_numbers.hpp"
#include "dcem/sim/detail/receiver_memory.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::detail {

/// Transmitters by their numbers; those whose object is away are absent.
struct TransmitterEnds {
  std::span<const Device> devices;  ///< all of them
  std::vector<std::optional<LinkEnd>> link;
  std::vector<std::optional<RadioEnd>> radio;  ///< of all devices, each made by the thread that has it; see `radio_of`
  std::vector<ReachedEdges> reached;           ///< the edges within reach; empty lists where no diffraction is wanted
  std::vector<EdgeReach> own_reach;            ///< holds them where nothing is remembered
  HalfRefs halves;                             ///< none where the plan has none
  std::vector<KeptHalf> own_halves;            ///< holds them where nothing is kept
  SceneContacts contacts;                      ///< what is known; empty where nobody has looked
  /// What each sees of surfaces, where diffuse power is asked for; none of those that are away.
  std::vector<std::shared_ptr<LitSurfaces>> surfaces;
  std::shared_ptr<const ScatteringLimits> limits;  ///< of the scene's materials, where diffuse power is asked for
  WorkCounters work;                               ///< what finding them took
  std::vector<std::uint32_t> numbers;              ///< of those that were chosen; empty: as they stand in the scene
  const TransmitterEnds* all = nullptr;            ///< those that they were chosen from
  std::shared_ptr<const DeviceNumbers> by_id{};    ///< none where some were chosen

  /// The number among all devices.
  std::size_t number(std::size_t index) const { return numbers.empty() ? index : numbers[index]; }
  const Device& device(std::size_t index) const { return devices[number(index)]; }
  const RadioEnd& radio_of(std::size_t index) const { return *(all != nullptr ? all->radio : radio)[number(index)]; }
  /// Some of them, for a receiver that has no links with the others. These must outlive the result.
  TransmitterEnds only(std::vector<std::uint32_t> chosen) const;

  /// What a receiver sees that is a transmitter, too, with lists where they are asked for; none where that has not been
  /// worked out.
  const KeptHalf* half_of(const std::string& receiver, const LinkEnd& end, bool with_lists) const;
  /// What such a receiver sees of surfaces; none where that has not been worked out.
  std::shared_ptr<const SurfaceView> view_of(const std::string& receiver, const LinkEnd& end) const;

 private:
  /// The number of a transmitter of this name and place.
  std::optional<std::uint32_t> same_as(const std::string& receiver, const LinkEnd& end) const;
};

/// One end of a link, as paths and as fields see it.
struct DeviceEnd {
  const LinkEnd& link;
  const RadioEnd& radio;
};

inline TransmitterEnds TransmitterEnds::only(std::vector<std::uint32_t> chosen) const {
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

inline std::optional<std::uint32_t> TransmitterEnds::same_as(const std::string& receiver, const LinkEnd& end) const {
  if (by_id == nullptr) return std::nullopt;
  const auto found = by_id->find(receiver);
  if (found == by_id->end() || !link[found->second] || !same_bits(link[found->second], end)) return std::nullopt;
  return found->second;
}

inline const KeptHalf* TransmitterEnds::half_of(const std::string& receiver, const LinkEnd& end,
                                                bool with_lists) const {
  if (all != nullptr) return all->half_of(receiver, end, with_lists);
  const std::optional<std::uint32_t> number = halves.empty() ? std::nullopt : same_as(receiver, end);
  if (!number) return nullptr;
  const KeptHalf& half = halves[*number];
  return half.is_of_frame() && (!with_lists || half.lists() != nullptr) ? &half : nullptr;
}

inline std::shared_ptr<const SurfaceView> TransmitterEnds::view_of(const std::string& receiver,
                                                                   const LinkEnd& end) const {
  if (all != nullptr) return all->view_of(receiver, end);
  const std::optional<std::uint32_t> number = surfaces.empty() ? std::nullopt : same_as(receiver, end);
  if (!number) return nullptr;
  return {surfaces[*number], &surfaces[*number]->view};
}

}  // namespace dcem::detail
