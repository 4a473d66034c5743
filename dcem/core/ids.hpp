#pragma once
/// Strong index types: a facet id cannot be handed over where a material id is expected.
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace dcem {

/// Index into one array of the scene. `Tag` only tells the arrays apart.
template <typename Tag>
struct Id {
  std::uint32_t value = 0;

  constexpr Id() = default;
  constexpr explicit Id(std::size_t index) : value(static_cast<std::uint32_t>(index)) {}
  friend constexpr auto operator<=>(Id, Id) = default;
};

using FacetId = Id<struct FacetTag>;        ///< a facet of the whole scene
using WedgeId = Id<struct WedgeTag>;        ///< a diffracting edge of the whole scene
using BodyId = Id<struct BodyTag>;          ///< 0 is the standing scenery, objects follow
using MaterialId = Id<struct MaterialTag>;  ///< a material of the scene

}  // namespace dcem

template <typename Tag>
struct std::hash<dcem::Id<Tag>> {
  std::size_t operator()(dcem::Id<Tag> id) const noexcept { return std::hash<std::uint32_t>{}(id.value); }
};
