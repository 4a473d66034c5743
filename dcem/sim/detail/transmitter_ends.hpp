#pragma once
/// The transmitters of a frame, as the paths and the fields of links need them.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dcem/field/diffuse/scattering_limits.hpp"
#include "dcem/field/radio_end.hpp"
#include "dcem/paths/discover/edge_reach.hpp"
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

}  // namespace dcem::detail

#if !defined(DCEM_ENGINE)
#include "dcem/sim/detail/transmitter_ends_bodies.hpp"
#endif
