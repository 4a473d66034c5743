#pragma once
/// Looks for what an end reaches directly and over each of its mirrors.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "dcem/paths/halves/lanes.hpp"
#include "dcem/paths/halves/path_half.hpp"
#include "dcem/paths/solve/edge_rules.hpp"

namespace dcem {

class ThreadPool;

/// A mirror of an end, and the image in it.
struct BeamMirror {
  FacetId facet;
  Vec3 image_m;  ///< from the scene's origin
  std::span<const HalfSpace> cone;
};

/// Where it is looked for. `half` must stay as it is as long as what is found is used.
struct BeamSource {
  const Scene& scene;
  const FacetOutlines& outlines;
  const LaneScene& lanes;
  const PathHalf& half;
  HalfSettings settings;
  bool over_mirrors;           ///< look through the mirrors, too
  ThreadPool* pool = nullptr;  ///< looks through many mirrors at once; none: the calling thread does
  int most_pieces = 64;        ///< of edges seen over mirrors of the scenery, of an end that stands: see `BeamFinder`
};

/// What has been found, in the order in which it was.
struct BeamFinds {
  std::vector<std::array<std::uint32_t, 2>> pairs;  ///< a facet, and the place of the mirror that lights it
  std::vector<EdgePart> parts;                      ///< seen directly; `edge`: the number of a wedge
  std::vector<EdgePart> lit;                        ///< `edge`: the place of the mirror that lights it
  std::vector<std::uint32_t> lit_edges;             ///< for each of them the number of the wedge

  void append(const BeamFinds& more) {
    pairs.insert(pairs.end(), more.pairs.begin(), more.pairs.end());
    parts.insert(parts.end(), more.parts.begin(), more.parts.end());
    lit.insert(lit.end(), more.lit.begin(), more.lit.end());
    lit_edges.insert(lit_edges.end(), more.lit_edges.begin(), more.lit_edges.end());
  }
};

class BeamFinder {
 public:
  /// Of the view through a mirror that is too wide to be looked through along one axis.
  static constexpr int view_pixels = 128;
  /// Edges are looked up in pieces of half a metre, or of a pixel of the view, as many as this at most: more of them
  /// find less of each edge, once for all receivers; for one receiver looking takes longer than that saves.
  static constexpr int many_pieces = 64, few_pieces = 1;

  BeamFinder(const BeamSource& source, std::span<const BeamMirror> mirrors) : source_(source), mirrors_(mirrors) {}

  /// The parts of a layer's edges that may be seen directly: as `look_through` from any number of threads, where the
  /// half is settled.
  void find_parts(const HalfLayer& layer, int most_pieces, BeamFinds& finds) const;
  /// Which facets of the scenery the end may light over edges of which it sees parts, those from `first` to `last` − 1
  /// of all, edge by edge: the number of a facet, and the place of the part.
  void look_over_edges(std::span<const EdgePart> parts, std::size_t first, std::size_t last,
                       std::vector<std::array<std::uint32_t, 2>>& lit) const;
  /// What may be seen through the mirrors `first` … `last` − 1 of the scenery and, where they are asked for, of bodies:
  /// the same in the same order from any number of threads.
  void look_through(std::size_t first, std::size_t last, bool bodies, int most_pieces, BeamFinds& finds) const;
  /// What may be seen through all mirrors, as the place in which the end is knows it for any point of it: of the
  /// scenery.
  void take_from(const Place& place, BeamFinds& finds) const;
  /// Chosen bodies, over the mirrors `first` … `last` − 1: everything in their cones, without a view.
  void reach_bodies(std::size_t first, std::size_t last, const BodyChoice& bodies, BeamFinds& finds) const;

 private:
  void find_parts_of(std::span<const WedgeId> edges, int most_pieces, std::vector<EdgePart>& parts) const;
  void look_through_block(std::size_t first, std::size_t last, bool bodies, int most_pieces, BeamFinds& finds) const;
  template <typename Visit>
  void for_each_shown(const Sight& sight, WedgeId edge, const EdgePart& part, int most_pieces, Visit&& visit) const;
  static double least_piece_m(const Sight& sight, const EdgePart& part);
  template <typename ForEach>
  void find_lit_parts(std::uint32_t mirror, std::span<const FacetId> facets, ForEach&& for_each,
                      BeamFinds& finds) const;
  EdgePart lit_part(WedgeId edge, std::uint32_t mirror) const;
  const std::optional<BodyId>& ignored_body() const { return source_.half.ignored_body(); }

  const BeamSource& source_;
  std::span<const BeamMirror> mirrors_;
};

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/paths/halves/beam_finder_bodies.hpp"
#endif
