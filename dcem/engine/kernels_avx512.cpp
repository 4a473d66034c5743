// The walks through the wide tree, compiled for x86-64-v4.
#include "dcem/accel/wide/trace/kernel_table.hpp"
#include "dcem/engine/kernels.hpp"

namespace dcem::detail {

const WideKernels& wide_kernels_avx512() {
  return kernel_table;
}

}  // namespace dcem::detail
