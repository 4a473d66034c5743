#pragma once
/// Which instructions the code is compiled for, and which the processor has.
#include <cstdint>
#include <string_view>

/// Code in whose types or functions the width of registers shows stands in `namespace dcem { inline namespace
/// DCEM_ISA`: compiled for several processors in one program it has other names each time, and none replaces another.
/// What merely holds eight lanes (core/simd.hpp) has the same size and alignment for all of them.
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
#define DCEM_ISA isa_avx512
#elif defined(__AVX2__)
#define DCEM_ISA isa_avx2
#else
#define DCEM_ISA isa_baseline
#endif

namespace dcem {

/// Levels for which the tracing of rays, and what joins halves of paths, is compiled. Results do not depend on them, to
/// the last bit.
enum class InstructionSet : std::uint8_t {
  baseline,  ///< whatever the compiler assumes; on x86-64 its first generation
  avx2,      ///< x86-64-v3: registers of eight single-precision numbers
  avx512     ///< x86-64-v4: the same width, with masks and twice the registers
};

constexpr std::string_view name_of(InstructionSet set) {
  return set == InstructionSet::avx512 ? "avx512" : set == InstructionSet::avx2 ? "avx2" : "baseline";
}

/// The level of the code in which this stands.
inline namespace DCEM_ISA {
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
inline constexpr InstructionSet compiled_instruction_set = InstructionSet::avx512;
#elif defined(__AVX2__)
inline constexpr InstructionSet compiled_instruction_set = InstructionSet::avx2;
#else
inline constexpr InstructionSet compiled_instruction_set = InstructionSet::baseline;
#endif
}  // namespace DCEM_ISA

/// Whether the processor that runs this has all instructions of a level, and the operating system keeps its registers.
inline bool is_supported(InstructionSet set) {
#if defined(__x86_64__) || defined(__i386__)
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
                    __builtin_cpu_supports("fma") && __builtin_cpu_supports("popcnt");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
                      __builtin_cpu_supports("avx512cd");
  return set == InstructionSet::avx512 ? avx512 : set == InstructionSet::avx2 ? avx2 : true;
#else
  return set == InstructionSet::baseline;
#endif
}

#if defined(DCEM_ENGINE)

/// The level that is used in this program: at first the highest one that the processor has.
InstructionSet instruction_set();

/// Uses another level from now on. Throws std::invalid_argument where the processor does not have it. Not while rays
/// are traced or paths are looked for on other threads.
void select_instruction_set(InstructionSet set);

#else

inline namespace DCEM_ISA {

/// The level that this file is compiled for, and that is used.
inline InstructionSet instruction_set() {
  return compiled_instruction_set;
}

}  // namespace DCEM_ISA

#endif

}  // namespace dcem
