#pragma once
/// The walks for the level of instructions that this is compiled for.
#include "dcem/accel/wide/trace/closest_hits.hpp"
#include "dcem/accel/wide/trace/kernels.hpp"
#include "dcem/accel/wide/trace/queries.hpp"

namespace dcem {

namespace detail {

inline namespace DCEM_ISA {

inline constexpr WideKernels kernel_table{compiled_instruction_set, &closest_hit, &occluded, &visit_hits, &closest_hits,
                                          &closest_hits_of_fan};

#if !defined(DCEM_ENGINE)
inline const WideKernels& wide_kernels() {
  return kernel_table;
}
#endif

}  // namespace DCEM_ISA

}  // namespace detail

}  // namespace dcem
