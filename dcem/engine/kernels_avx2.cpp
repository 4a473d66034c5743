// The walks through the wide tree, those of cones, of candidates, of edges' images and of views, compiled for
// x86-64-v3.
#include "dcem/accel/wide/trace/kernel_table.hpp"
#include "dcem/engine/kernels.hpp"

namespace dcem::detail {

const EngineKernels& engine_kernels_avx2() {
  static constexpr EngineKernels kernels{kernel_table, cone_kernel_table, candidate_kernel_table, keller_kernel_table,
                                         view_kernel_table};
  return kernels;
}

}  // namespace dcem::detail
