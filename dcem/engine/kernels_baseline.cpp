// The walks through the wide tree, compiled for whatever the compiler assumes.
#include "dcem/accel/wide/trace/kernel_table.hpp"
#include "dcem/engine/kernels.hpp"

namespace dcem::detail {

const WideKernels& wide_kernels_baseline() {
  return kernel_table;
}

}  // namespace dcem::detail
