#pragma once
/// The walks through the wide tree, and those of cones, compiled several times in one library.
#include "dcem/accel/wide/trace/kernels.hpp"
#include "dcem/paths/halves/cone_kernels.hpp"

namespace dcem::detail {

/// For one level of instructions.
struct EngineKernels {
  WideKernels wide;
  ConeKernels cone;
};

const EngineKernels& engine_kernels_baseline();
const EngineKernels& engine_kernels_avx2();
const EngineKernels& engine_kernels_avx512();

}  // namespace dcem::detail
