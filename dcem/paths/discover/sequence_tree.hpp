#pragma once
/// Sequences of mirrors that share their beginnings, each with the images of one end.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/image_method.hpp"

namespace dcem {

/// Rays that were reflected at the same mirrors stand at the same node; node 0 is the end itself, before any mirror.
/// One that begins anew asks for no memory that it has had.
class SequenceTree {
 public:
  explicit SequenceTree(const Vec3& end_m) { begin(end_m); }

  /// Forgets all but the end.
  void begin(const Vec3& end_m) {
    nodes_.assign(1, {0, 0, FacetId{}, end_m});
    std::fill(places_.begin(), places_.end(), nobody);
  }

  /// The node one mirror on, and whether it is new.
  std::pair<std::uint32_t, bool> step(std::uint32_t from, FacetId mirror, const Plane& plane) {
    if (2 * (nodes_.size() + 1) > places_.size()) grow();
    std::uint32_t& place = places_[place_of(from, mirror)];
    if (place != nobody) return {place, false};
    place = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({from, nodes_[from].depth + 1, mirror, mirrored(plane, nodes_[from].image_m)});
    return {place, true};
  }

  std::size_t depth(std::uint32_t node) const { return nodes_[node].depth; }

  /// The mirrors from the end to a node, and the images of the end: one more, the end itself first.
  void unfold(std::uint32_t node, Sequence& sequence, std::vector<Vec3>& images_m) const {
    const std::size_t depth = nodes_[node].depth;
    sequence.assign(depth, SequenceElement(FacetId{}));
    images_m.resize(depth + 1);
    for (std::size_t index = depth; index > 0; --index, node = nodes_[node].parent) {
      sequence[index - 1] = nodes_[node].mirror;
      images_m[index] = nodes_[node].image_m;
    }
    images_m[0] = nodes_[0].image_m;
  }

 private:
  struct Node {
    std::uint32_t parent, depth;
    FacetId mirror;
    Vec3 image_m;
  };
  static constexpr std::uint32_t nobody = 0xffffffffU;

  /// Where the number of a node stands, or the free place where it would.
  std::size_t place_of(std::uint32_t from, FacetId mirror) const {
    const std::size_t mask = places_.size() - 1;
    std::size_t place = static_cast<std::size_t>(hash_values(std::uint64_t{from} << 32U | mirror.value)) & mask;
    while (places_[place] != nobody && !is_behind(places_[place], from, mirror)) place = (place + 1) & mask;
    return place;
  }
  bool is_behind(std::uint32_t node, std::uint32_t from, FacetId mirror) const {
    return nodes_[node].parent == from && nodes_[node].mirror == mirror;
  }
  void grow() {
    places_.assign(std::max<std::size_t>(64, 2 * places_.size()), nobody);
    for (std::uint32_t node = 1; node < nodes_.size(); ++node) {
      places_[place_of(nodes_[node].parent, nodes_[node].mirror)] = node;
    }
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> places_;  ///< of nodes by what is behind them; a power of two, half of them free
};

}  // namespace dcem
