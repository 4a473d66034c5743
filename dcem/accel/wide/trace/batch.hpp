#pragma once
/// Many rays at once through a wide tree.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/wide/trace/ray_order.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/parallel_for.hpp"

namespace dcem {

/// Asks a tree about a list of rays in an order in which they are cheap. The answers are those of single queries, for
/// any number of threads. A batch pays where rays begin everywhere and go far, and more in larger scenes; where they
/// are short, or come in a good order already, sorting costs more than it brings (docs/design/wide_tree.md). Keeps its
/// memory from call to call; not for two threads at once.
class WideBatch {
 public:
  /// `threads`: of a call (number); 0: as many as the machine has.
  explicit WideBatch(unsigned threads = 1) : threads_(threads) {}

  /// WideBvh::closest_hit of every ray. Throws std::invalid_argument where there is not one place for each answer.
  template <typename Considers = WideBvh::EveryTriangle>
  void closest_hit(const WideBvh& tree, std::span<const Ray<double>> rays, std::span<std::optional<TriangleHit>> hits,
                   const Considers& considers = {}, TraversalCounters* counters = nullptr) {
    trace(rays, hits, counters,
          [&](const Ray<double>& ray, TraversalCounters& spent) { return tree.closest_hit(ray, considers, &spent); });
  }

  /// WideBvh::occluded of every ray: 1 or 0. Throws as `closest_hit`.
  template <typename Considers = WideBvh::EveryTriangle>
  void occluded(const WideBvh& tree, std::span<const Ray<double>> rays, std::span<std::uint8_t> is_occluded,
                const Considers& considers = {}, TraversalCounters* counters = nullptr) {
    trace(rays, is_occluded, counters, [&](const Ray<double>& ray, TraversalCounters& spent) {
      return static_cast<std::uint8_t>(tree.occluded(ray, considers, &spent) ? 1 : 0);
    });
  }

 private:
  static constexpr std::size_t piece = 256;  ///< rays that a thread takes at once

  template <typename Answer, typename Ask>
  void trace(std::span<const Ray<double>> rays, std::span<Answer> answers, TraversalCounters* counters, Ask&& ask) {
    if (answers.size() != rays.size()) throw std::invalid_argument("one place per ray is needed for the answers");
    const std::span<const std::uint32_t> order = order_.sort(rays);
    spent_.assign((rays.size() + piece - 1) / piece, {});
    parallel_for(spent_.size(), threads_, [&](std::size_t index, unsigned) {
      const auto own = order.subspan(index * piece, std::min(piece, rays.size() - index * piece));
      // What lies scattered is fetched, and written, all at once: then it does not wait one by one.
      std::array<Ray<double>, piece> ray;
      std::array<Answer, piece> answer;
      for (std::size_t at = 0; at < own.size(); ++at) ray[at] = rays[own[at]];
      for (std::size_t at = 0; at < own.size(); ++at) answer[at] = ask(ray[at], spent_[index]);
      for (std::size_t at = 0; at < own.size(); ++at) answers[own[at]] = answer[at];
    });
    if (counters == nullptr) return;
    for (const TraversalCounters& spent : spent_) *counters += spent;
  }

  unsigned threads_;
  RayOrder order_;
  std::vector<TraversalCounters> spent_;
};

}  // namespace dcem
