#include "dcem/io/src/scenario/json_reader.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "dcem/core/error.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/known_names.hpp"
#include "dcem/io/src/scenario/limits.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

using nlohmann::json;

}  // namespace

void JsonValue::fail(const std::string& what) const {
  throw InputError(place(), (path_.empty() ? "" : printable(path_) + ": ") + what);
}

std::string JsonValue::place() const {
  const std::size_t line = document_->line_of(path_);
  return line == 0 ? document_->name() : document_->name() + ":" + std::to_string(line);
}

void JsonValue::fail_expected(const std::string& expectation) const {
  const json::error_handler_t repair = json::error_handler_t::replace;
  fail((value_->is_structured() ? std::string("found an ") + value_->type_name()
                                : "found " + in_quotes(value_->dump(-1, ' ', false, repair))) +
       "; expected " + expectation);
}

void JsonValue::fail_expected() const {
  DCEM_ASSERT(forms_ != nullptr);
  fail_expected(keys::text_of(*forms_));
}

bool JsonValue::may_be(keys::ValueKind kind) const {
  return forms_ != nullptr && keys::find_form(*forms_, kind) != nullptr;
}

const keys::ValueRule& JsonValue::rule(keys::ValueKind kind) const {
  DCEM_ASSERT(may_be(kind));
  return *keys::find_form(*forms_, kind);
}

bool JsonValue::is_null() const {
  return value_->is_null();
}
bool JsonValue::is_object() const {
  return value_->is_object();
}
bool JsonValue::is_string() const {
  return value_->is_string();
}
bool JsonValue::is_number() const {
  return value_->is_number();
}
bool JsonValue::is_boolean() const {
  return value_->is_boolean();
}

bool JsonValue::boolean() const {
  const std::vector<std::string>& words = rule(keys::ValueKind::boolean).words;
  if (!value_->is_boolean() || (!words.empty() && words.front() != value_->dump())) fail_expected();
  return value_->get<bool>();
}

std::string JsonValue::text() const {
  if (!value_->is_string() || value_->get_ref<const std::string&>().empty()) fail_expected();
  return value_->get<std::string>();
}

std::string JsonValue::line() const {
  const std::string text = this->text();
  if (!is_printable(text)) fail_expected();
  return text;
}

std::string JsonValue::identifier() const {
  const std::string name = text();
  const bool plain = is_printable(name) && name.find_first_of("/\\") == std::string::npos;
  if (!plain || name.size() > longest_identifier_bytes) fail_expected();
  return name;
}

std::string JsonValue::word() const {
  const std::vector<std::string>& words = rule(keys::ValueKind::word).words;
  if (!value_->is_string()) fail_expected();
  const auto found = std::find(words.begin(), words.end(), value_->get_ref<const std::string&>());
  if (found == words.end()) fail_expected();
  return *found;
}

double JsonValue::number() const {
  const NumberRange& range = rule(keys::ValueKind::number).range;
  if (!value_->is_number()) fail_expected();
  const double value = value_->get<double>();
  if (!std::isfinite(value) || !range.holds(value)) fail_expected();
  return value;
}

long long JsonValue::integer() const {
  const NumberRange& range = rule(keys::ValueKind::whole_number).range;
  const auto minimum = static_cast<long long>(range.minimum), maximum = static_cast<long long>(range.maximum);
  if (!value_->is_number()) fail_expected();
  if (value_->is_number_unsigned() && value_->get<unsigned long long>() > static_cast<unsigned long long>(maximum)) {
    fail_expected();
  }
  if (value_->is_number_float()) {
    // 2e3 is a whole number too; beyond 2^53 a double cannot tell one from the next.
    const double real = value_->get<double>();
    if (!(std::abs(real) <= 9007199254740992.0) || real != std::floor(real)) fail_expected();
  }
  const auto value = value_->get<long long>();
  if (value < minimum || value > maximum) fail_expected();
  return value;
}

Vec3 JsonValue::vector3() const {
  const std::vector<JsonValue> numbers = elements();
  DCEM_ASSERT(numbers.size() == 3);
  return {numbers[0].number(), numbers[1].number(), numbers[2].number()};
}

std::vector<JsonValue> JsonValue::elements() const {
  const keys::ValueRule& list = rule(keys::ValueKind::list);
  if (!value_->is_array() || (list.most > 0 && value_->size() != list.most)) fail_expected();
  if (value_->size() < list.least) fail("empty; expected at least one " + list.noun);
  std::vector<JsonValue> result;
  result.reserve(value_->size());
  for (const json& element : *value_) {
    result.emplace_back(*document_, element, path_ + "[" + std::to_string(result.size()) + "]", &list.element);
  }
  return result;
}

JsonObject JsonValue::object() const {
  return object(*rule(keys::ValueKind::block).block);
}

JsonObject JsonValue::object(const keys::BlockRule& block) const {
  if (!value_->is_object()) forms_ == nullptr ? fail_expected("an object {...}") : fail_expected();
  std::map<std::string, JsonValue> members;
  for (const auto& [key, value] : value_->items()) {
    const keys::KeyRule* known = keys::find_key(block, key);
    if (known == nullptr) fail_unknown(block, key);
    members.emplace(key, JsonValue(*document_, value, child_path(key), &known->forms));
  }
  return {*this, block, std::move(members)};
}

void JsonValue::fail_unknown(const keys::BlockRule& block, const std::string& key) const {
  const JsonValue place(*document_, (*value_)[key], child_path(key), nullptr);
  for (const keys::Elsewhere& other : block.elsewhere) {
    if (other.key == key) place.fail(other.says);
  }
  place.fail("unknown key" + expected_names(key, keys::key_names(block)));
}

JsonValue JsonValue::member(const std::string& key) const {
  DCEM_ASSERT(value_->is_object() && value_->contains(key));
  const keys::KeyRule* known = keys::find_key(*rule(keys::ValueKind::block).block, key);
  DCEM_ASSERT(known != nullptr);
  return {*document_, (*value_)[key], child_path(key), &known->forms};
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::entries() const {
  if (!value_->is_object()) fail_expected();
  std::vector<std::pair<std::string, JsonValue>> result;
  for (const auto& [key, value] : value_->items())
    result.emplace_back(key, JsonValue(*document_, value, child_path(key), forms_));
  return result;
}

// ---------------------------------------------------------------------------------------------------------------------

std::optional<JsonValue> JsonObject::find(const std::string& key) const {
  DCEM_ASSERT(keys::find_key(*block_, key) != nullptr);
  const auto member = members_.find(key);
  return member == members_.end() ? std::nullopt : std::optional(member->second);
}

JsonValue JsonObject::at(const std::string& key) const {
  const std::optional<JsonValue> value = find(key);
  if (!value) fail("the key '" + key + "' is missing; expected it here");
  return *value;
}

std::string JsonObject::chosen(const std::string& choice) const {
  const auto rule = std::find_if(block_->choices.begin(), block_->choices.end(),
                                 [&](const keys::Choice& other) { return other.name == choice; });
  DCEM_ASSERT(rule != block_->choices.end());
  std::vector<std::string> found;
  for (const std::string& key : rule->keys) {
    if (has(key)) found.push_back(key);
  }
  if (found.size() == 1) return found.front();
  fail("found " + (found.empty() ? "none" : keys::enumeration(found, ", ")) + "; expected exactly one of " +
       keys::enumeration(rule->keys, ", "));
}

double JsonObject::number(const std::string& key, double absent) const {
  const std::optional<JsonValue> value = find(key);
  return value ? value->number() : absent;
}

long long JsonObject::integer(const std::string& key, long long absent) const {
  const std::optional<JsonValue> value = find(key);
  return value ? value->integer() : absent;
}

std::size_t JsonObject::count(const std::string& key, std::size_t absent) const {
  const std::optional<JsonValue> value = find(key);
  return value ? static_cast<std::size_t>(value->integer()) : absent;
}

bool JsonObject::boolean(const std::string& key, bool absent) const {
  const std::optional<JsonValue> value = find(key);
  return value ? value->boolean() : absent;
}

}  // namespace dcem::io
