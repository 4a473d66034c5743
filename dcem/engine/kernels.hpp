#pragma once
/// The walks through the wide tree, those of cones, of candidates, of edges' images and of views, compiled several
/// times in one library.
#include "dcem/accel/wide/trace/kernels.hpp"
#include "dcem/paths/halves/cone_kernels.hpp"
#include "dcem/paths/halves/keller_kernels.hpp"
#include "dcem/paths/halves/view_kernels.hpp"
#include "dcem/paths/memory/candidate_kernels.hpp"

namespace dcem::detail {

/// For one level of instructions.
struct EngineKernels {
  WideKernels wide;
  ConeKernels cone;
  CandidateKernels candidates;
  KellerKernels keller;
  ViewKernels view;
};

const EngineKernels& engine_kernels_baseline();
const EngineKernels& engine_kernels_avx2();
const EngineKernels& engine_kernels_avx512();

}  // namespace dcem::detail
