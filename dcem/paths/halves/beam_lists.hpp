#pragma once
/// What an end reaches directly and over each of its mirrors, listed by what is reached.
///
/// Worked out once for many receivers; of an end that stands, what concerns the scenery alone is kept while bodies
/// move, and what concerns bodies while these stand.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/halves/beam_table.hpp"

namespace dcem {

class BeamLists {
 public:
  static constexpr std::uint32_t nothing = BeamTable::nothing;
  /// Of an end that is looked at once.
  void find_all(const BeamSource& source);
  /// Of an end in a place that knows what may be seen through its mirrors: the images in all of them must be laid out.
  /// `moved` as in `find_bodies`.
  void find_from(const BeamSource& source, const Place& place, std::span<const char> moved);
  /// Of an end that stands, what does not change while bodies move …
  void find_scenery(const BeamSource& source);
  /// … or a part of it after the other: what is seen directly, and then, until it says that all is there, what is seen
  /// over some mirrors more, as long as any of the work is left that it may spend, µs as measured in Munich, and takes
  /// off …
  void begin_scenery(const BeamSource& source);
  bool go_on(const BeamSource& source, double& work_us);
  /// … then, as well, which facets of the scenery are lit over some more of the parts of edges that are seen. Where
  /// there would be more than `most_lit_over` of them, it says that all is there, and nothing is known.
  bool go_on_over_edges(const BeamSource& source, double& work_us);
  static constexpr std::size_t most_lit_over = 16'000'000;  ///< they take four bytes each, and three times that before
  /// … and the rest. The scenery's must be known. `moved` as in `PathHalf::find_bodies`; `follows`: what was listed of
  /// bodies is that of the frame before, and stays true of those that have not moved.
  void find_bodies(const BeamSource& source, std::span<const char> moved = {}, bool follows = false);
  /// Whether it is known which facets are lit over edges.
  bool knows_edges() const { return tables_[of_scenery].knows_parts_before(); }
  /// Whether what moves is listed, too.
  bool has_bodies() const { return has_bodies_; }

  const PathHalf& half() const { return *half_; }
  /// Of the numbers in single precision.
  const Vec3& origin_m() const { return lanes_->origin_m(); }
  /// Where the end is, from there.
  const Vec3& position_m() const { return position_m_; }
  /// The body that the end rides on.
  const std::optional<BodyId>& ignored_body() const { return half_->ignored_body(); }
  std::span<const BeamMirror> mirrors() const { return mirrors_; }
  /// The place of a facet among the mirrors, or `nothing`.
  std::uint32_t mirror_of(FacetId facet) const { return mirror_of_[facet.value]; }

  /// What is listed: of the scenery alone; over bodies that have moved, in what is reached or in the mirror; over other
  /// bodies. What has been found all at once is in the first.
  static constexpr std::size_t of_scenery = 0, of_moved = 1, of_others = 2;
  std::span<const BeamTable, 3> tables() const { return tables_; }

  /// Asks for what is listed of a facet that is soon asked about.
  [[gnu::always_inline]] void fetch(FacetId facet) const {
    for (const BeamTable& table : tables_) table.fetch(facet);
  }
  /// Of all of them, as `BeamTable` has it: the places of the mirrors over which the end may light a facet, and whose
  /// images may lie in a cone …
  template <typename Visit>
  void for_each_mirror_before(FacetId facet, std::span<const HalfSpace> cone, Visit&& visit) const {
    for (const BeamTable& table : tables_) table.for_each_mirror_before(facet, cone, visit);
  }
  bool lights(FacetId facet) const {
    return std::any_of(tables_.begin(), tables_.end(), [&](const BeamTable& table) { return table.lights(facet); });
  }
  /// … the parts of edges that the end may see …
  std::vector<EdgePart> parts() const {
    std::vector<EdgePart> all;
    for (const BeamTable& table : tables_) all.insert(all.end(), table.parts().begin(), table.parts().end());
    return all;
  }
  template <typename Visit>
  void for_each_part_of(WedgeId edge, Visit&& visit) const {
    for (const BeamTable& table : tables_) std::ranges::for_each(table.parts_of(edge), visit);
  }
  template <typename Visit>
  void for_each_part_before(FacetId facet, std::span<const HalfSpace> cone, const Vec3& apex, float radius_m,
                            Visit&& visit) const {
    for (const BeamTable& table : tables_) table.for_each_part_before(facet, cone, apex, radius_m, visit);
  }
  template <typename Visit>
  void for_each_part_in(std::span<const HalfSpace> cone, const Vec3& apex, float radius_m, Visit&& visit) const {
    for (const BeamTable& table : tables_) table.for_each_part_in(cone, apex, radius_m, visit);
  }
  /// … and those that mirrors may light.
  bool lights(WedgeId edge) const {
    return std::any_of(tables_.begin(), tables_.end(), [&](const BeamTable& table) { return table.lights(edge); });
  }
  template <typename Visit>
  void for_each_lit_part(WedgeId edge, const Vec3& point, float radius_m, Visit&& visit) const {
    for (const BeamTable& table : tables_) table.for_each_lit_part(edge, point, radius_m, visit);
  }

 private:
  void note_mirrors(const BeamSource& source, std::size_t first_layer, std::size_t layers);
  double look_through_more(const BeamSource& source, std::size_t mirrors);
  double look_over_more(const BeamSource& source, std::size_t parts);
  BeamFinds find_moved(const BeamSource& source, std::span<const char> moved) const;
  BeamFinds find_others(const BeamSource& source, std::span<const char> moved) const;
  void keep_standing(const BeamSource& source, std::span<const char> moved, std::span<const FacetId> before);

  const PathHalf* half_ = nullptr;
  const LaneScene* lanes_ = nullptr;
  bool has_bodies_ = false;
  std::size_t looked_through_ = 0;  ///< so many mirrors, where the scenery's are worked out one after the other
  std::size_t looked_over_ = 0;     ///< so many parts of edges
  std::vector<std::array<std::uint32_t, 2>> lit_over_;  ///< as `BeamFinder` has it, until all are known
  Vec3 position_m_{0.0};
  std::array<BeamFinds, 3> found_;  ///< as the tables; of the scenery until it is laid out
  std::vector<BeamMirror> mirrors_;
  std::vector<std::uint32_t> mirror_of_;
  std::array<BeamTable, 3> tables_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/beam_lists_bodies.hpp"
#endif
