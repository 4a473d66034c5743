#pragma once
/// The walks of cone_walk.hpp and window_walk.hpp as a table of functions: there is one for each level of instructions
/// that they are compiled for, and all give the same answers, to the last bit.
#include <cstddef>
#include <cstdint>
#include <span>

#include "dcem/paths/halves/cone_walk.hpp"
#include "dcem/paths/halves/window_walk.hpp"

namespace dcem {

namespace detail {

struct ConeKernels {
  void (*boxes)(const BoxTree& tree, std::span<const EightBoxes> boxes, std::span<const HalfSpace> cone,
                const EightsVisitor& visit);
  void (*parts)(const BoxTree& tree, std::span<const EightParts> parts, std::span<const HalfSpace> cone,
                const ConeTarget& target, const EightsVisitor& visit);
  /// Where it is the end that may be elsewhere.
  void (*parts_of_moving_end)(const BoxTree& tree, std::span<const EightParts> parts, std::span<const HalfSpace> cone,
                              const ConeTarget& target, const EightsVisitor& visit);
  void (*images)(const BoxTree& tree, std::span<const EightImages> images, std::span<const HalfSpace> cone,
                 const ConeTarget& target, const EightsVisitor& visit);
  void (*listed_parts)(std::span<const PartRecord> all, std::span<const std::uint32_t> numbers,
                       std::span<const HalfSpace> cone, const ConeTarget& target, const EightsVisitor& visit);
  void (*points)(const PointRow& row, std::span<const HalfSpace> cone, const EightsVisitor& visit);
  void (*mirrored)(const PointRow& row, const WindowOutline& window, std::span<const CentredBox> boxes,
                   const EightsVisitor& visit);
};

inline namespace DCEM_ISA {

/// For the level of instructions that this is compiled for.
inline constexpr ConeKernels cone_kernel_table{&visit_boxes,   &visit_parts<false>, &visit_parts<true>,
                                               &visit_images,  &visit_listed_parts, &visit_points,
                                               &visit_mirrored};

#if !defined(DCEM_ENGINE)
inline const ConeKernels& cone_kernels() {
  return cone_kernel_table;
}
#endif

}  // namespace DCEM_ISA

#if defined(DCEM_ENGINE)
/// Those of `instruction_set()`.
const ConeKernels& cone_kernels();
#endif

}  // namespace detail

/// Has `visit(first, lanes)` told what the visitor is told; it must outlive the visitor.
template <typename Visit>
EightsVisitor told_to(Visit& visit) {
  return {[](void* context, std::size_t first, std::uint32_t lanes) { (*static_cast<Visit*>(context))(first, lanes); },
          const_cast<void*>(static_cast<const void*>(&visit))};
}

}  // namespace dcem
