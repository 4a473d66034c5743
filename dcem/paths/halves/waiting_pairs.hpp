#pragma once
/// Pairs of elements that wait until what they are asked about has come from memory.
///
/// In a large city each mirror and each edge lies somewhere else, and waiting for it takes longer than the question: so
/// pairs are collected, and while one is asked about, those after it are fetched.
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "dcem/paths/halves/join_gates.hpp"

namespace dcem {

class WaitingPairs {
 public:
  /// An element of one end, by its place there, and one of the other that may come next to it.
  struct Pair {
    std::uint32_t near, far;
  };

  void add(std::uint32_t near, std::uint32_t far) { pairs_.push_back({near, far}); }

  /// Where many wait: calls `ask(near, far)` for all of them, in their order; what is fetched before is
  /// `element_of(far)`.
  template <typename ElementOf, typename Ask>
  void ask_if_many(const JoinGates& gates, ElementOf&& element_of, Ask&& ask) {
    constexpr std::size_t many = 512;  // what is known of them stays near
    if (pairs_.size() >= many) ask_all(gates, element_of, ask);
  }
  /// The same of however many.
  template <typename ElementOf, typename Ask>
  void ask_all(const JoinGates& gates, ElementOf&& element_of, Ask&& ask) {
    constexpr std::size_t ahead = 16, soon = 8;
    for (std::size_t at = 0; at < pairs_.size(); ++at) {
      if (at + ahead < pairs_.size()) gates.fetch(element_of(pairs_[at + ahead].far));
      if (at + soon < pairs_.size()) gates.fetch_more(element_of(pairs_[at + soon].far));
      ask(pairs_[at].near, pairs_[at].far);
    }
    pairs_.clear();
  }

 private:
  std::vector<Pair> pairs_;
};

}  // namespace dcem
