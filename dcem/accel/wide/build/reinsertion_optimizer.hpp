#pragma once
/// Makes a binary tree cheaper by putting nodes elsewhere. It takes longer than building the tree.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/accel/wide/build/binary_tree.hpp"
#include "dcem/accel/wide/build/binner.hpp"
#include "dcem/core/thread_pool.hpp"

namespace dcem {

/// Takes nodes out of a binary tree, each with all that is below it, and hangs them where the sum of all surfaces grows
/// least (Bittner, Hapala, Havran, "Fast insertion-based optimization of bounding volume hierarchies", Computer
/// Graphics Forum 2013).
///
/// Passes as in Meister and Bittner, "Parallel reinsertion for bounding volume hierarchy optimization" (Computer
/// Graphics Forum 2018): the best move of every node is looked for in the tree as it stands, in threads; then the moves
/// are made one by one, the greatest gain first, each weighed anew. So the sum never rises, and the tree is the same
/// for any number of threads.
class ReinsertionOptimizer {
 public:
  static constexpr int most_passes = 10;
  static constexpr double least_gain = 1e-3;  ///< a pass that gains a smaller part of the sum is the last one
  /// A search looks at no more nodes: boxes that all overlap would make it look at all of them.
  static constexpr int most_visits = 200;

  /// Changes the tree and the order of its items. It gets no deeper than detail::wide_build_depth_limit: a pass that
  /// makes it deeper is taken back, and the last one.
  static void optimize(std::vector<WideSplit>& splits, std::span<WideItem> items, unsigned threads) {
    if (splits.size() < 5) return;  // three leaves at least
    ReinsertionOptimizer work(detail::with_boxes(splits, items), threads);
    if (!std::isfinite(work.nodes_.front().half_area_m2)) return;
    const std::vector<WideItem> before(items.begin(), items.end());
    std::vector<WideItem> placed(items.size());
    for (int pass = 0; pass < most_passes; ++pass) {
      const double sum_m2 = work.sum_m2();
      const double gain_m2 = work.pass();
      std::vector<WideSplit> better = detail::in_order(work.nodes_, 0, before, placed);
      if (!(gain_m2 > 0.0) || detail::depth_of_tree(better) > detail::wide_build_depth_limit) break;
      splits = std::move(better);
      std::copy(placed.begin(), placed.end(), items.begin());
      if (gain_m2 < least_gain * sum_m2) break;
    }
  }

 private:
  using Node = detail::BinaryNode;
  struct Move {
    float gain_m2 = 0.0F;
    std::uint32_t from = 0;
    std::uint32_t to = 0;  ///< its new sibling
  };
  /// A place to insert something, or to look below.
  struct Spot {
    float gain_m2;  ///< without what a node around the two would cost
    std::uint32_t node;
  };

  ReinsertionOptimizer(std::vector<Node> nodes, unsigned threads) : nodes_(std::move(nodes)), threads_(threads) {}

  double sum_m2() const {
    double sum = 0.0;
    for (const Node& node : nodes_) sum += node.is_leaf() ? 0.0 : static_cast<double>(node.half_area_m2);
    return sum;
  }

  /// Returns what the sum has lost.
  double pass() {
    std::vector<Move> moves = best_moves();
    std::erase_if(moves, [](const Move& move) { return !(move.gain_m2 > 0.0F); });
    std::sort(moves.begin(), moves.end(), [](const Move& one, const Move& other) {
      return one.gain_m2 != other.gain_m2 ? one.gain_m2 > other.gain_m2 : one.from < other.from;
    });
    double gain_m2 = 0.0;
    for (const Move& move : moves) gain_m2 += try_move(move.from, move.to);
    return gain_m2;
  }

  std::vector<Move> best_moves() const {
    std::vector<Move> moves(nodes_.size());
    constexpr std::size_t at_a_time = 256;
    parallel_for((nodes_.size() + at_a_time - 1) / at_a_time, threads_, [&](std::size_t part, unsigned) {
      std::vector<Spot> open;
      const std::size_t last = std::min(nodes_.size(), (part + 1) * at_a_time);
      for (std::size_t node = part * at_a_time; node < last; ++node) {
        // A child of the root would take the root with it.
        if (nodes_[node].parent != 0) moves[node] = best_move(static_cast<std::uint32_t>(node), open);
      }
    });
    return moves;
  }

  std::uint32_t sibling(std::uint32_t node) const {
    const Node& parent = nodes_[nodes_[node].parent];
    return parent.left == node ? parent.right : parent.left;
  }

  /// Looks below the siblings of the node's parents, one after the other: what hangs there leaves all above as it is.
  Move best_move(std::uint32_t from, std::vector<Spot>& open) const {
    Move best{0.0F, from, 0};
    int visits = 0;
    std::uint32_t pivot = nodes_[from].parent;
    float gain_m2 = nodes_[pivot].half_area_m2;  // the node that goes
    detail::FloatBox left_behind = nodes_[sibling(from)].box;
    search_below(sibling(from), gain_m2, open, best, visits);
    while (pivot != 0 && visits < most_visits) {
      const std::uint32_t beside = sibling(pivot);
      search_below(beside, gain_m2, open, best, visits);
      pivot = nodes_[pivot].parent;
      left_behind.extend(nodes_[beside].box);
      gain_m2 += nodes_[pivot].half_area_m2 - left_behind.half_area();
    }
    return best;
  }

  /// Branch and bound: below a node the gain is no larger than what is left without the moved box's own surface.
  void search_below(std::uint32_t top, float gain_m2, std::vector<Spot>& open, Move& best, int& visits) const {
    const Node& moved = nodes_[best.from];
    open.assign(1, {gain_m2, top});
    while (!open.empty()) {
      const Spot spot = open.back();
      open.pop_back();
      if (spot.gain_m2 - moved.half_area_m2 <= best.gain_m2 || ++visits > most_visits) continue;
      const Node& target = nodes_[spot.node];
      detail::FloatBox both = target.box;
      both.extend(moved.box);
      const float here_m2 = spot.gain_m2 - both.half_area();
      if (here_m2 > best.gain_m2 && target.parent != moved.parent) {
        best.gain_m2 = here_m2;
        best.to = spot.node;
      }
      if (target.is_leaf()) continue;
      open.push_back({here_m2 + target.half_area_m2, target.left});
      open.push_back({here_m2 + target.half_area_m2, target.right});
    }
  }

  /// Moves where the sum falls, as the tree is now. Returns what it has lost.
  double try_move(std::uint32_t from, std::uint32_t to) {
    const std::uint32_t joint = nodes_[from].parent, beside = sibling(from);
    // Other moves may have made this one pointless, or have put the target below what moves.
    if (joint == 0 || to == joint || to == beside || is_below(to, from)) return 0.0;
    const double grown_m2 = change_place(joint, from, to);
    if (grown_m2 < 0.0) return -grown_m2;
    change_place(joint, from, beside);
    return 0.0;
  }

  bool is_below(std::uint32_t node, std::uint32_t above) const {
    while (node != 0 && node != above) node = nodes_[node].parent;
    return node == above;
  }

  /// Takes a node out together with its parent, which becomes the parent of it and `to`. Returns by how much the sum
  /// has grown.
  double change_place(std::uint32_t joint, std::uint32_t from, std::uint32_t to) {
    const std::uint32_t above = nodes_[joint].parent;
    replace_child(above, joint, sibling(from));
    replace_child(nodes_[to].parent, to, joint);
    nodes_[joint].left = to;
    nodes_[joint].right = from;
    nodes_[to].parent = joint;
    double grown_m2 = fit(joint);
    grown_m2 += fit_from(nodes_[joint].parent);
    return grown_m2 + fit_from(above);
  }

  void replace_child(std::uint32_t parent, std::uint32_t old_child, std::uint32_t child) {
    (nodes_[parent].left == old_child ? nodes_[parent].left : nodes_[parent].right) = child;
    nodes_[child].parent = parent;
  }

  /// Makes a node's box tight. Returns by how much its surface has grown.
  double fit(std::uint32_t slot) {
    Node& node = nodes_[slot];
    const float before_m2 = node.half_area_m2;
    node.box = nodes_[node.left].box;
    node.box.extend(nodes_[node.right].box);
    node.half_area_m2 = node.box.half_area();
    return static_cast<double>(node.half_area_m2) - static_cast<double>(before_m2);
  }
  /// The same for a node and all above, as far up as boxes change.
  double fit_from(std::uint32_t slot) {
    double grown_m2 = 0.0;
    while (true) {
      const detail::FloatBox before = nodes_[slot].box;
      grown_m2 += fit(slot);
      if (slot == 0 || nodes_[slot].box == before) return grown_m2;
      slot = nodes_[slot].parent;
    }
  }

  std::vector<Node> nodes_;  ///< the root stays at 0
  unsigned threads_;
};

}  // namespace dcem
