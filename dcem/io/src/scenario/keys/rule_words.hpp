#pragma once
/// The words in which the tables of keys are written. Private to dcem::io.
#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "dcem/io/src/scenario/enum_words.hpp"
#include "dcem/io/src/scenario/keys/key_rules.hpp"
#include "dcem/io/src/scenario/limits.hpp"

namespace dcem::io::keys {

inline ValueRule of_kind(ValueKind kind) {
  ValueRule rule;
  rule.kind = kind;
  return rule;
}

inline ValueRule boolean() {
  return of_kind(ValueKind::boolean);
}
inline ValueRule null() {
  return of_kind(ValueKind::null);
}
inline ValueRule text() {
  return of_kind(ValueKind::text);
}
inline ValueRule line() {
  return of_kind(ValueKind::line);
}
inline ValueRule identifier() {
  return of_kind(ValueKind::identifier);
}
inline ValueRule file() {
  return of_kind(ValueKind::file);
}

inline ValueRule number(const NumberRange& range, const std::string& unit = {}) {
  ValueRule rule = of_kind(ValueKind::number);
  rule.range = range;
  rule.unit = unit;
  return rule;
}

/// Bounds that a double holds exactly.
inline ValueRule whole_number(double minimum, double maximum) {
  ValueRule rule = of_kind(ValueKind::whole_number);
  rule.range = {minimum, maximum};
  return rule;
}

inline ValueRule with_words(ValueKind kind, std::vector<std::string> words) {
  ValueRule rule = of_kind(kind);
  rule.words = std::move(words);
  return rule;
}

/// Only the one of both.
inline ValueRule only(bool value) {
  return with_words(ValueKind::boolean, {value ? "true" : "false"});
}
inline ValueRule word(std::vector<std::string> words) {
  return with_words(ValueKind::word, std::move(words));
}
/// The words of an enumeration.
template <typename Enum>
ValueRule word() {
  return word(words_of<Enum>());
}

inline ValueRule block(const BlockRule& keys) {
  ValueRule rule = of_kind(ValueKind::block);
  rule.block = &keys;
  return rule;
}
inline ValueRule entries(const BlockRule& each) {
  ValueRule rule = of_kind(ValueKind::entries);
  rule.block = &each;
  return rule;
}

/// As many elements as there are, of which `noun` is one: "waypoint".
inline ValueRule list(const ValueRule& element, std::size_t least, const std::string& noun) {
  ValueRule rule = of_kind(ValueKind::list);
  rule.element = {element};
  rule.least = least;
  rule.noun = noun;
  return rule;
}
/// `noun` as in "three numbers [x, y, z]".
inline ValueRule fixed_list(std::size_t count, const ValueRule& element, const std::string& noun) {
  ValueRule rule = list(element, count, noun);
  rule.most = count;
  return rule;
}
inline ValueRule three_numbers(const NumberRange& range, const std::string& unit,
                               const std::string& noun = "three numbers [x, y, z]") {
  return fixed_list(3, number(range, unit), noun);
}
inline ValueRule position_m() {
  return three_numbers({-farthest_coordinate_m, farthest_coordinate_m}, "m");
}

inline Absence required() {
  return {Absence::Kind::error, {}};
}
/// One of the keys of a choice must be there.
inline Absence chosen() {
  return {Absence::Kind::choice, {}};
}
/// It must be there beside other keys: "required with box_m".
inline Absence required(std::string when) {
  return {Absence::Kind::demand, "required " + std::move(when)};
}
/// What holds, in words.
inline Absence told(std::string sentence) {
  return {Absence::Kind::told, std::move(sentence)};
}
/// A value of the settings as they are before anything is read.
template <typename Value>
Absence standard(const Value& value) {
  if constexpr (std::is_same_v<Value, bool>)
    return {Absence::Kind::value, value ? "true" : "false"};
  else if constexpr (std::is_enum_v<Value>)
    return {Absence::Kind::value, '"' + std::string(word_of(value)) + '"'};
  else if constexpr (std::is_integral_v<Value>)
    return {Absence::Kind::value, std::to_string(value)};
  else
    return {Absence::Kind::value, number_text(value)};
}

/// Of files: whether they are written, and, where there are any, with which settings.
inline KeyRule yes_or_no(const std::string& name, bool absent, const std::string& meaning) {
  return {name, {boolean()}, standard(absent), meaning, "true"};
}
inline KeyRule yes_or_settings(const std::string& name, const BlockRule& settings, const std::string& meaning) {
  return {name, {boolean(), block(settings)}, standard(false), meaning, "true"};
}

}  // namespace dcem::io::keys
