#pragma once
/// The walks through a wide tree as a table of functions: there is one for each level of instructions that they are
/// compiled for, and all give the same answers, to the last bit.
#include <cstdint>
#include <optional>
#include <span>

#include "dcem/accel/counters.hpp"
#include "dcem/accel/hit_filter.hpp"
#include "dcem/core/instruction_set.hpp"
#include "dcem/geometry/ray.hpp"

namespace dcem {

struct WideArrays;

namespace detail {

/// See the queries of `WideBvh`.
struct WideKernels {
  InstructionSet instruction_set;
  std::optional<TriangleHit> (*closest_hit)(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                                            TraversalCounters& counters);
  bool (*occluded)(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter,
                   TraversalCounters& counters);
  bool (*visit_hits)(const WideArrays& tree, const Ray<double>& ray, const HitFilter& filter, const HitVisitor& visitor,
                     TraversalCounters& counters);
  void (*closest_hits)(const WideArrays& tree, std::span<const RayQuery> queries,
                       std::span<std::optional<TriangleHit>> hits, TraversalCounters& counters);
  void (*closest_hits_of_fan)(const WideArrays& tree, const RayFan& fan, std::span<std::optional<TriangleHit>> hits,
                              TraversalCounters& counters);
};

}  // namespace detail

#if defined(DCEM_ENGINE)

namespace detail {

/// Those of `instruction_set()`.
const WideKernels& wide_kernels();

}  // namespace detail

#endif

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/accel/wide/trace/kernel_table.hpp"  // says which: what the program is compiled for
#endif
