#pragma once
/// The words of enumerations in scenarios and results: one table for each, to read and to write by. Private to
/// dcem::io.
#include <array>
#include <string>
#include <vector>

#include "dcem/accel/wide/settings.hpp"
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
  static constexpr std::array in_files{EnumWord{CacheMode::off, "off"}, EnumWord{CacheMode::seed, "seed"}};
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

template <typename Enum>
const char* word_of(Enum value) {
  for (const EnumWord<Enum>& entry : EnumWords<Enum>::in_files) {
    if (entry.value == value) return entry.word;
  }
  if constexpr (requires { EnumWords<Enum>::otherwise; }) return EnumWords<Enum>::otherwise;
  return "";
}

/// Throws InputError for any other word.
template <typename Enum>
Enum read_word(const JsonValue& value) {
  std::vector<std::string> words;
  for (const EnumWord<Enum>& entry : EnumWords<Enum>::in_files) words.emplace_back(entry.word);
  const std::string word = value.one_of(words);
  for (const EnumWord<Enum>& entry : EnumWords<Enum>::in_files) {
    if (word == entry.word) return entry.value;
  }
  value.fail_expected("one of its words");  // not reached: one_of has checked
}

/// The same where the key may be missing.
template <typename Enum>
Enum read_word(const JsonObject& object, const std::string& key, Enum otherwise) {
  const auto value = object.find(key);
  return value ? read_word<Enum>(*value) : otherwise;
}

}  // namespace dcem::io
