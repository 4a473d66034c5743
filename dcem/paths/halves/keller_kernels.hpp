#pragma once
/// The loops of keller_walk.hpp as a table of functions: there is one for each level of instructions that they are
/// compiled for, and all give the same answers, to the last bit.
#include <cstdint>

#include "dcem/paths/halves/keller_walk.hpp"

namespace dcem::detail {

struct KellerKernels {
  std::uint32_t (*shows)(const KellerCells& cells, const KellerOutline& outline);
  void (*cover)(KellerCells& cells, const KellerOutline& outline);
};

inline namespace DCEM_ISA {

/// For the level of instructions that this is compiled for.
inline constexpr KellerKernels keller_kernel_table{&keller_shows, &keller_cover};

#if !defined(DCEM_ENGINE)
inline const KellerKernels& keller_kernels() {
  return keller_kernel_table;
}
#endif

}  // namespace DCEM_ISA

#if defined(DCEM_ENGINE)
/// Those of `instruction_set()`.
const KellerKernels& keller_kernels();
#endif

}  // namespace dcem::detail
