#include <nlohmann/json.hpp>

#include "dcem/io/scenario_keys.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"
#include "dcem/io/src/scenario/limits.hpp"

namespace dcem::io {

namespace {

using keys::BlockRule;
using keys::KeyRule;
using keys::ValueKind;
using keys::ValueRule;
using Schema = nlohmann::ordered_json;

/// No control characters; in an identifier no slashes either. A name may be empty.
constexpr const char* name_pattern = R"(^[^\u0000-\u001f\u007f]*$)";
constexpr const char* line_pattern = R"(^[^\u0000-\u001f\u007f]+$)";
constexpr const char* identifier_pattern = R"(^[^/\\\u0000-\u001f\u007f]+$)";

Schema schema_of(const std::vector<ValueRule>& forms);

/// "propagation.diffraction", "transmitters"; under this name a block stands in `$defs`.
std::string definition_name(const BlockRule& block) {
  std::string name;
  for (const char letter : block.path) {
    if (letter != '[' && letter != ']') name += letter == '*' ? '_' : letter;
  }
  return name;
}

Schema reference_to(const BlockRule& block) {
  return {{"$ref", "#/$defs/" + definition_name(block)}};
}

Schema number_schema(const ValueRule& rule) {
  const bool is_whole = rule.kind == ValueKind::whole_number;
  const auto bound = [&](double value) { return is_whole ? Schema(static_cast<long long>(value)) : Schema(value); };
  return {{"type", is_whole ? "integer" : "number"},
          {rule.range.above_minimum ? "exclusiveMinimum" : "minimum", bound(rule.range.minimum)},
          {"maximum", bound(rule.range.maximum)}};
}

Schema text_schema(const char* pattern) {
  Schema schema{{"type", "string"}, {"minLength", 1}};
  if (pattern != nullptr) schema["pattern"] = pattern;
  return schema;
}

Schema list_schema(const ValueRule& rule) {
  Schema schema{{"type", "array"}, {"items", schema_of(rule.element)}};
  if (rule.least > 0) schema["minItems"] = rule.least;
  if (rule.most > 0) schema["maxItems"] = rule.most;
  return schema;
}

Schema entries_schema(const BlockRule& each) {
  return {
      {"type", "object"}, {"propertyNames", {{"pattern", name_pattern}}}, {"additionalProperties", reference_to(each)}};
}

Schema schema_of(const ValueRule& rule) {
  switch (rule.kind) {
    case ValueKind::boolean:
      return rule.words.empty() ? Schema{{"type", "boolean"}} : Schema{{"const", rule.words.front() == "true"}};
    case ValueKind::null:
      return {{"type", "null"}};
    case ValueKind::number:
    case ValueKind::whole_number:
      return number_schema(rule);
    case ValueKind::word:
      return {{"enum", rule.words}};
    case ValueKind::text:
    case ValueKind::file:
      return text_schema(nullptr);
    case ValueKind::line:
      return text_schema(line_pattern);
    case ValueKind::identifier: {
      Schema schema = text_schema(identifier_pattern);
      schema["maxLength"] = longest_identifier_bytes;
      return schema;
    }
    case ValueKind::list:
      return list_schema(rule);
    case ValueKind::block:
      return reference_to(*rule.block);
    case ValueKind::entries:
      return entries_schema(*rule.block);
  }
  return false;
}

Schema schema_of(const std::vector<ValueRule>& forms) {
  Schema any = Schema::array();
  for (const ValueRule& form : forms) any.push_back(schema_of(form));
  return any.size() == 1 ? any.front() : Schema{{"anyOf", any}};
}

Schema key_schema(const KeyRule& key) {
  Schema schema = schema_of(key.forms);
  const std::string unit = keys::unit_of(key.forms);
  schema["description"] = key.meaning + (unit.empty() ? "" : " Unit: " + unit + ".");
  if (key.absence.kind == keys::Absence::Kind::value) schema["default"] = Schema::parse(key.absence.text);
  if (key.absence.kind == keys::Absence::Kind::told) schema["$comment"] = "Without it: " + key.absence.text + ".";
  if (key.absence.kind == keys::Absence::Kind::demand) schema["$comment"] = key.absence.text;
  if (!key.example.empty()) schema["examples"] = Schema::array({Schema::parse(key.example)});
  return schema;
}

/// One of the keys of each choice, and no second one.
Schema choices_schema(const BlockRule& block) {
  Schema all = Schema::array();
  for (const keys::Choice& choice : block.choices) {
    Schema one = Schema::array();
    for (const std::string& key : choice.keys) one.push_back({{"required", Schema::array({key})}});
    all.push_back({{"oneOf", one}});
  }
  return all;
}

Schema block_schema(const BlockRule& block) {
  Schema schema{{"description", block.meaning}, {"type", "object"}, {"properties", Schema::object()}};
  Schema required = Schema::array();
  for (const KeyRule& key : block.keys) {
    schema["properties"][key.name] = key_schema(key);
    if (key.absence.kind == keys::Absence::Kind::error) required.push_back(key.name);
  }
  if (!required.empty()) schema["required"] = required;
  if (!block.choices.empty()) schema["allOf"] = choices_schema(block);
  schema["additionalProperties"] = false;
  return schema;
}

}  // namespace

std::string scenario_schema() {
  const BlockRule& scenario = keys::scenario_block();
  Schema schema{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                {"$id", "urn:dcem:scenario:1"},
                {"title", "DCEM scenario, version 1"}};
  schema.update(block_schema(scenario));
  for (const BlockRule* block : keys::blocks_from(scenario)) {
    if (block != &scenario) schema["$defs"][definition_name(*block)] = block_schema(*block);
  }
  return schema.dump(2) + "\n";
}

}  // namespace dcem::io
