#pragma once
/// The ways of a link over points of rough surfaces, part by part: all points of a visible part are reached through the
/// same sheets.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/paths/path.hpp"
#include "dcem/paths/query/link_end.hpp"
#include "dcem/paths/visible/part_list.hpp"

namespace dcem {

/// Of one link; its ends and the scene must outlive it. Number 0 is a surface of which nothing is known, and has no
/// sheets; number 1 is that of all parts without sheets.
class ScatterWays {
 public:
  ScatterWays(const Scene& scene, const LinkEnd& transmitter, const LinkEnd& receiver);

  /// A number for the ways over a part.
  std::uint32_t number_of(const PartList& parts, std::size_t part);

  /// The sheets on both legs of such ways.
  std::span<const FacetId> sheets(std::uint32_t number) const {
    return number == 0 ? std::span<const FacetId>() : std::span<const FacetId>(ways_[number - 1].sheets);
  }

  /// The way over a point; where it crosses a single sheet is not said. Valid until the next one is asked for.
  const Path& over(std::uint32_t number, FacetId facet, const Vec3& point_m);

  /// Such a way with the points where it crosses sheets, in their order.
  Path listed(const Path& way) const;

 private:
  struct Way {
    Path path;
    std::size_t place = 0;  ///< of the scattering
    std::vector<FacetId> sheets{};
  };

  /// Where a leg meets the plane of a sheet, 0…1.
  double share(const Vec3& from_m, const Vec3& to_m, FacetId sheet) const;

  static void add_sheets(std::span<const FacetId> sheets, Way& way);

  /// Says where a way crosses its sheets, leg by leg.
  void put_in_order(Path& way) const;

  void put_in_order(const Vec3& from_m, const Vec3& to_m, std::span<Interaction> crossings) const;

  const Scene& scene_;
  const LinkEnd& transmitter_;
  const LinkEnd& receiver_;
  std::vector<Way> ways_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/field/diffuse/scatter_ways_bodies.hpp"
#endif
