#pragma once
/// The loops of view_walk.hpp as a table of functions: there is one for each level of instructions that they are
/// compiled for, and all give the same answers, to the last bit.
#include "dcem/paths/halves/view_walk.hpp"

namespace dcem::detail {

struct ViewKernels {
  void (*cover)(const FacePixels& face, float* pixels, const FaceOutline& outline, const FaceNearness& nearness);
  void (*cover_both)(const FacePixels& face, float* pixels, const FaceOutline& outline, const FaceNearness& nearness,
                     const FaceNearness& other);
  bool (*shows)(const FacePixels& face, const FaceOutline& outline, const FaceNearness& nearness, double nearer);
  bool (*hides_box)(const FacePixels& face, const FacePoint& low, const FacePoint& high, double nearer);
};

inline namespace DCEM_ISA {

/// For the level of instructions that this is compiled for.
inline constexpr ViewKernels view_kernel_table{&view_cover, &view_cover_both, &view_shows, &view_hides_box};

#if !defined(DCEM_ENGINE)
inline const ViewKernels& view_kernels() {
  return view_kernel_table;
}
#endif

}  // namespace DCEM_ISA

#if defined(DCEM_ENGINE)
/// Those of `instruction_set()`.
const ViewKernels& view_kernels();
#endif

}  // namespace dcem::detail
