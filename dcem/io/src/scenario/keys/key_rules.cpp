#include "dcem/io/src/scenario/keys/key_rules.hpp"

#include <algorithm>

#include "dcem/io/src/scenario/limits.hpp"

namespace dcem::io::keys {

namespace {

/// Text with a unit behind it, where there is one and it is wanted.
std::string with_unit_of(const ValueRule& rule, const std::string& text, bool with_unit) {
  return with_unit && !rule.unit.empty() ? text + " " + rule.unit : text;
}

/// Whole numbers with all their digits: 100000, not 1e5.
std::string whole_text(const NumberRange& range) {
  return "from " + std::to_string(static_cast<long long>(range.minimum)) + " to " +
         std::to_string(static_cast<long long>(range.maximum));
}

std::string list_text(const ValueRule& rule, bool with_unit) {
  const ValueRule& element = rule.element.front();
  if (rule.most == 0) {
    return element.kind == ValueKind::word ? "an array [...] of " + enumeration(element.words) : "an array [...]";
  }
  if (element.kind == ValueKind::whole_number) return rule.noun + ", each " + whole_text(element.range);
  if (element.kind != ValueKind::number) return rule.noun;
  return rule.noun + ", each " + with_unit_of(element, element.range.bounds_text(), with_unit);
}

std::string block_text(const BlockRule& block) {
  constexpr std::size_t few = 2;
  return block.keys.size() > few ? "an object {...}" : "an object {...} with " + enumeration(key_names(block));
}

std::string form_text(const ValueRule& rule, bool with_unit, bool alone) {
  switch (rule.kind) {
    case ValueKind::boolean:
      return rule.words.empty() ? "true or false" : rule.words.front();
    case ValueKind::null:
      return "null";
    case ValueKind::number:
      return with_unit_of(rule, rule.range.text(), with_unit);
    case ValueKind::whole_number:
      return "a whole number " + whole_text(rule.range);
    case ValueKind::word:
      return alone || rule.words.size() > 1 ? enumeration(rule.words) : in_quotes(rule.words[0]);
    case ValueKind::text:
      return "text that is not empty";
    case ValueKind::line:
      return "text without control characters";
    case ValueKind::identifier:
      return "a name without slashes and control characters, at most " + std::to_string(longest_identifier_bytes) +
             " bytes";
    case ValueKind::file:
      return "the name of a file";
    case ValueKind::list:
      return list_text(rule, with_unit);
    case ValueKind::block:
      return block_text(*rule.block);
    case ValueKind::entries:
      return "an object {...}";
  }
  return {};
}

}  // namespace

const KeyRule* find_key(const BlockRule& block, std::string_view name) {
  const auto key =
      std::find_if(block.keys.begin(), block.keys.end(), [&](const KeyRule& other) { return other.name == name; });
  return key == block.keys.end() ? nullptr : &*key;
}

const ValueRule* find_form(const std::vector<ValueRule>& forms, ValueKind kind) {
  const auto form = std::find_if(forms.begin(), forms.end(), [&](const ValueRule& rule) { return rule.kind == kind; });
  return form == forms.end() ? nullptr : &*form;
}

const Choice* choice_of(const BlockRule& block, std::string_view key) {
  const auto choice = std::find_if(block.choices.begin(), block.choices.end(), [&](const Choice& other) {
    return std::find(other.keys.begin(), other.keys.end(), key) != other.keys.end();
  });
  return choice == block.choices.end() ? nullptr : &*choice;
}

bool fits_mtl(const BlockRule& block, const KeyRule& key) {
  return !block.mtl_prefix.empty() && find_form(key.forms, ValueKind::list) == nullptr;
}

std::vector<std::string> key_names(const BlockRule& block) {
  std::vector<std::string> names;
  for (const KeyRule& key : block.keys) names.push_back(key.name);
  return names;
}

std::vector<std::string> mtl_names(const BlockRule& block) {
  std::vector<std::string> names;
  for (const KeyRule& key : block.keys) {
    if (fits_mtl(block, key)) names.push_back(block.mtl_prefix + key.name);
  }
  return names;
}

const BlockRule* block_of(const std::vector<ValueRule>& forms) {
  for (const ValueRule& form : forms) {
    const BlockRule* block = form.kind == ValueKind::list ? block_of(form.element) : form.block;
    if (block != nullptr) return block;
  }
  return nullptr;
}

std::vector<const BlockRule*> blocks_from(const BlockRule& root) {
  std::vector<const BlockRule*> found{&root};
  for (const KeyRule& key : root.keys) {
    const BlockRule* block = block_of(key.forms);
    if (block == nullptr) continue;
    for (const BlockRule* below : blocks_from(*block)) {
      if (std::find(found.begin(), found.end(), below) == found.end()) found.push_back(below);
    }
  }
  return found;
}

std::string enumeration(const std::vector<std::string>& words, const std::string& last) {
  std::string text;
  for (std::size_t index = 0; index < words.size(); ++index) {
    text += (index == 0 ? "" : index + 1 < words.size() ? ", " : last) + words[index];
  }
  return text;
}

std::string text_of(const std::vector<ValueRule>& forms, bool with_unit) {
  std::vector<std::string> texts;
  for (const ValueRule& form : forms) texts.push_back(form_text(form, with_unit, forms.size() == 1));
  return enumeration(texts);
}

std::string unit_of(const std::vector<ValueRule>& forms) {
  for (const ValueRule& form : forms) {
    const std::string unit = form.kind == ValueKind::list ? unit_of(form.element) : form.unit;
    if (!unit.empty()) return unit;
  }
  return {};
}

std::string absence_text(const BlockRule& block, const KeyRule& key) {
  switch (key.absence.kind) {
    case Absence::Kind::error:
      return "required";
    case Absence::Kind::choice:
      return "one of " + enumeration(choice_of(block, key.name)->keys, ", ");
    case Absence::Kind::demand:
    case Absence::Kind::value:
    case Absence::Kind::told:
      break;
  }
  return key.absence.text;
}

}  // namespace dcem::io::keys
