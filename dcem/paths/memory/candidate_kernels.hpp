#pragma once
/// The walks of candidate_walk.hpp as a table of functions: there is one for each level of instructions that they are
/// compiled for, and all give the same answers, to the last bit.
#include <span>

#include "dcem/paths/memory/candidate_walk.hpp"

namespace dcem::detail {

struct CandidateKernels {
  void (*over_edges)(std::span<const EightCandidates> all, const CandidatePoint& point, const EightsVisitor& visit);
  void (*over_mirrors)(std::span<const EightCandidates> all, std::span<const CandidateMirror> mirrors,
                       const CandidatePoint& point, const EightsVisitor& visit);
};

inline namespace DCEM_ISA {

/// For the level of instructions that this is compiled for.
inline constexpr CandidateKernels candidate_kernel_table{&visit_over_edges, &visit_over_mirrors};

#if !defined(DCEM_ENGINE)
inline const CandidateKernels& candidate_kernels() {
  return candidate_kernel_table;
}
#endif

}  // namespace DCEM_ISA

#if defined(DCEM_ENGINE)
/// Those of `instruction_set()`.
const CandidateKernels& candidate_kernels();
#endif

}  // namespace dcem::detail
