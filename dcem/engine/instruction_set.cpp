// Which of the compiled walks are used: chosen when the program starts, by what the processor has.
#include <atomic>
#include <stdexcept>
#include <string>

#include "dcem/accel/wide/trace/exact_bodies.hpp"
#include "dcem/engine/kernels.hpp"

namespace dcem {

namespace {

/// Null where this library does not hold them.
const detail::EngineKernels* kernels_of(InstructionSet set) {
  if (set == InstructionSet::baseline) return &detail::engine_kernels_baseline();
#if defined(DCEM_X86_KERNELS)
  return set == InstructionSet::avx2 ? &detail::engine_kernels_avx2() : &detail::engine_kernels_avx512();
#else
  return nullptr;
#endif
}

bool is_usable(InstructionSet set) {
  return is_supported(set) && kernels_of(set) != nullptr;
}

const detail::EngineKernels* best_kernels() {
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2}) {
    if (is_usable(set)) return kernels_of(set);
  }
  return kernels_of(InstructionSet::baseline);
}

std::atomic<const detail::EngineKernels*>& chosen_kernels() {
  static std::atomic<const detail::EngineKernels*> chosen{best_kernels()};
  return chosen;
}

}  // namespace

namespace detail {

const WideKernels& wide_kernels() {
  return chosen_kernels().load(std::memory_order_relaxed)->wide;
}

const ConeKernels& cone_kernels() {
  return chosen_kernels().load(std::memory_order_relaxed)->cone;
}

const CandidateKernels& candidate_kernels() {
  return chosen_kernels().load(std::memory_order_relaxed)->candidates;
}

const KellerKernels& keller_kernels() {
  return chosen_kernels().load(std::memory_order_relaxed)->keller;
}

const ViewKernels& view_kernels() {
  return chosen_kernels().load(std::memory_order_relaxed)->view;
}

}  // namespace detail

InstructionSet instruction_set() {
  return detail::wide_kernels().instruction_set;
}

void select_instruction_set(InstructionSet set) {
  if (!is_usable(set)) {
    throw std::invalid_argument("instruction set " + std::string(name_of(set)) +
                                ": this processor, or this build, does "
                                "not have it; it has up to " +
                                std::string(name_of(best_kernels()->wide.instruction_set)));
  }
  chosen_kernels() = kernels_of(set);
}

}  // namespace dcem
