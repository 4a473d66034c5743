#pragma once
/// The words of enumerations in scenarios and results: one table for each, to read and to write by. Private to
/// dcem::io.
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/accel/wide/settings.hpp"
#include "dcem/em/antenna/polarization.hpp"
#include "dcem/em/surface/effective_roughness.hpp"
#include "dcem/io/obj_reader.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/io/src/scenario/json_reader.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem::io {

template <typename Enum>
struct EnumWord {
  Enum value;
  const char* word;
};
template <typename Enum>
EnumWord(Enum, const char*) -> EnumWord<Enum>;  // clang 14 deduces none for aggregates

/// Words in the order in which a message lists them; `otherwise`: what results say of a value for which files have no
/// word.
template <typename Enum>
struct EnumWords;

template <>
struct EnumWords<Discovery> {
  static constexpr std::array in_files{EnumWord{Discovery::exact, "exact"}, EnumWord{Discovery::sampled, "sampled"}};
  static constexpr const char* otherwise = "automatic";
};
template <>
struct EnumWords<CacheMode> {
  static constexpr std::array in_files{EnumWord{CacheMode::off, "off"}, EnumWord{CacheMode::seed, "seed"},
                                       EnumWord{CacheMode::exact, "exact"}};
  static constexpr const char* otherwise = "automatic";
};
template <>
struct EnumWords<LossyWedge> {
  static constexpr std::array in_files{EnumWord{LossyWedge::holm_reciprocal, "holm_reciprocal"},
                                       EnumWord{LossyWedge::reciprocal, "reciprocal"},
                                       EnumWord{LossyWedge::luebbers84, "luebbers84"}};
};
template <>
struct EnumWords<DiffractionRegion> {
  static constexpr std::array in_files{EnumWord{DiffractionRegion::everywhere, "everywhere"},
                                       EnumWord{DiffractionRegion::shadow, "shadow"}};
};
template <>
struct EnumWords<DiffusePhases> {
  static constexpr std::array in_files{EnumWord{DiffusePhases::incoherent, "incoherent"},
                                       EnumWord{DiffusePhases::seeded, "seeded"}};
};
template <>
struct EnumWords<ArrayChannel> {
  static constexpr std::array in_files{EnumWord{ArrayChannel::plane_wave, "plane_wave"},
                                       EnumWord{ArrayChannel::exact, "exact"}};
};
template <>
struct EnumWords<PdpMode> {
  static constexpr std::array in_files{EnumWord{PdpMode::incoherent, "incoherent"},
                                       EnumWord{PdpMode::coherent, "coherent"},
                                       EnumWord{PdpMode::band_limited, "band_limited"}};
};
template <>
struct EnumWords<TreePolicy> {
  static constexpr std::array in_files{EnumWord{TreePolicy::adaptive, "adaptive"},
                                       EnumWord{TreePolicy::refit_only, "refit_only"},
                                       EnumWord{TreePolicy::rebuild_always, "rebuild_always"}};
};
template <>
struct EnumWords<WideQuality> {
  static constexpr std::array in_files{EnumWord{WideQuality::fast, "fast"}, EnumWord{WideQuality::good, "good"},
                                       EnumWord{WideQuality::high, "high"}};
};

template <>
struct EnumWords<UpAxis> {
  static constexpr std::array in_files{EnumWord{UpAxis::z, "z"}, EnumWord{UpAxis::y, "y"}};
};
/// A slant has no word but an angle.
template <>
struct EnumWords<PolarizationKind> {
  static constexpr std::array in_files{
      EnumWord{PolarizationKind::vertical, "V"}, EnumWord{PolarizationKind::horizontal, "H"},
      EnumWord{PolarizationKind::right_circular, "RHC"}, EnumWord{PolarizationKind::left_circular, "LHC"},
      EnumWord{PolarizationKind::dual, "VH"}};
};
template <>
struct EnumWords<ScatteringPattern> {
  static constexpr std::array in_files{EnumWord{ScatteringPattern::lambertian, "lambertian"},
                                       EnumWord{ScatteringPattern::directive, "directive"},
                                       EnumWord{ScatteringPattern::backscattering, "backscattering"}};
};

template <typename Enum>
const char* word_of(Enum value) {
  for (const EnumWord<Enum>& entry : EnumWords<Enum>::in_files) {
    if (entry.value == value) return entry.word;
  }
  if constexpr (requires { EnumWords<Enum>::otherwise; }) return EnumWords<Enum>::otherwise;
  return "";
}

template <typename Enum>
std::vector<std::string> words_of() {
  std::vector<std::string> words;
  for (const EnumWord<Enum>& entry : EnumWords<Enum>::in_files) words.emplace_back(entry.word);
  return words;
}

/// What a word of a file means; absent for any other.
template <typename Enum>
std::optional<Enum> meaning_of(std::string_view word) {
  for (const EnumWord<Enum>& entry : EnumWords<Enum>::in_files) {
    if (word == entry.word) return entry.value;
  }
  return std::nullopt;
}

/// Throws InputError for any other word.
template <typename Enum>
Enum read_word(const JsonValue& value) {
  const std::optional<Enum> meaning = meaning_of<Enum>(value.word());
  if (!meaning) value.fail_expected();  // the rule of the key has other words: a defect
  return *meaning;
}

/// The same where the key may be missing.
template <typename Enum>
Enum read_word(const JsonObject& object, const std::string& key, Enum otherwise) {
  const auto value = object.find(key);
  return value ? read_word<Enum>(*value) : otherwise;
}

}  // namespace dcem::io
