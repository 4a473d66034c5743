// The walks through the wide tree, compiled for x86-64-v3.
#include "dcem/accel/wide/trace/kernel_table.hpp"
#include "dcem/engine/kernels.hpp"

namespace dcem::detail {

const WideKernels& wide_kernels_avx2() {
  return kernel_table;
}

}  // namespace dcem::detail
