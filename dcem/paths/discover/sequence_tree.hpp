#pragma once
/// Sequences of mirrors that share their beginnings, each with the images of one end.
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "dcem/core/random.hpp"
#include "dcem/geometry/plane.hpp"
#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/image_method.hpp"

namespace dcem {

/// Rays that were reflected at the same mirrors stand at the same node; node 0 is the end itself, before any mirror.
class SequenceTree {
 public:
  explicit SequenceTree(const Vec3& end_m) : nodes_{{0, 0, FacetId{}, end_m}} {}

  /// The node one mirror on, and whether it is new.
  std::pair<std::uint32_t, bool> step(std::uint32_t from, FacetId mirror, const Plane& plane) {
    const auto [entry, is_new] =
        next_.try_emplace(std::uint64_t{from} << 32U | mirror.value, static_cast<std::uint32_t>(nodes_.size()));
    if (is_new) nodes_.push_back({from, nodes_[from].depth + 1, mirror, mirrored(plane, nodes_[from].image_m)});
    return {entry->second, is_new};
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
  struct Hash {
    std::size_t operator()(std::uint64_t key) const noexcept { return static_cast<std::size_t>(hash_values(key)); }
  };

  std::vector<Node> nodes_;
  std::unordered_map<std::uint64_t, std::uint32_t, Hash> next_;
};

}  // namespace dcem
