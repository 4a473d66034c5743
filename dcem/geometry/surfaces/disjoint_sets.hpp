#pragma once
/// Disjoint sets whose representative is their smallest member, so the result does not depend on the order of joins.
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace dcem {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  /// The smallest member of the set that holds `member`.
  std::uint32_t smallest(std::uint32_t member) {
    while (parent_[member] != member) {
      parent_[member] = parent_[parent_[member]];
      member = parent_[member];
    }
    return member;
  }

  void join(std::uint32_t a, std::uint32_t b) {
    a = smallest(a);
    b = smallest(b);
    if (a < b) {
      parent_[b] = a;
    } else {
      parent_[a] = b;
    }
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace dcem
