#pragma once
/// The walks through the wide tree, compiled several times in one library.
#include "dcem/accel/wide/trace/kernels.hpp"

namespace dcem::detail {

const WideKernels& wide_kernels_baseline();
const WideKernels& wide_kernels_avx2();
const WideKernels& wide_kernels_avx512();

}  // namespace dcem::detail
