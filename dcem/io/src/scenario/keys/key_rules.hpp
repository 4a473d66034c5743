#pragma once
/// What may stand in a scenario: blocks, their keys, the forms of their values. The reader goes by these rules; `dcem
/// keys`, the reference page and the JSON Schema are written from them. Private to dcem::io.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io::keys {

struct BlockRule;

enum class ValueKind {
  boolean,
  null,
  number,
  whole_number,
  word,        ///< one of a few
  text,        ///< not empty
  line,        ///< text on one line
  identifier,  ///< text that may stand in a file name and in one line
  file,        ///< its name, relative to the scenario
  list,
  block,   ///< an object with the keys of a block
  entries  ///< an object whose keys the user chooses; each value is a block
};

/// One form that a value may have.
struct ValueRule {
  ValueKind kind = ValueKind::null;
  NumberRange range{0.0, 0.0};       ///< of a number
  std::string unit{};                ///< of a number; empty: none
  std::vector<std::string> words{};  ///< which words; of a boolean "true" or "false" alone
  const BlockRule* block = nullptr;  ///< of a block or of entries
  std::vector<ValueRule> element{};  ///< of a list: the forms of each element
  std::size_t least = 0, most = 0;   ///< elements of a list; most 0: any number
  std::string noun{};                ///< of a list of fixed length: what it is; of any other: what one element is
};

/// What holds where a key is missing.
struct Absence {
  enum class Kind { error, choice, demand, value, told };
  Kind kind = Kind::error;
  std::string text{};  ///< of `demand` when the key must be there, of `value` JSON, of `told` what holds
};

struct KeyRule {
  std::string name;
  std::vector<ValueRule> forms;
  Absence absence;
  std::string meaning;  ///< one sentence
  std::string example;  ///< a value as JSON; empty for blocks, which have examples of their own
};

/// Keys of which exactly one must be there.
struct Choice {
  std::string name;
  std::vector<std::string> keys;
};

/// A key that stands in another block, and what is said where it is found here.
struct Elsewhere {
  std::string key, says;
};

struct BlockRule {
  std::string path;     ///< "propagation.diffraction", "transmitters[]"; of the scenario itself empty
  std::string meaning;  ///< one sentence
  std::vector<KeyRule> keys;
  std::vector<Choice> choices{};
  std::vector<Elsewhere> elsewhere{};
  std::string mtl_prefix{};  ///< in front of the keys in an MTL file; empty: they do not stand there
};

/// Null where there is none.
const KeyRule* find_key(const BlockRule& block, std::string_view name);
const ValueRule* find_form(const std::vector<ValueRule>& forms, ValueKind kind);
const Choice* choice_of(const BlockRule& block, std::string_view key);

/// Whether the key may stand in an MTL file, where there are no lists.
bool fits_mtl(const BlockRule& block, const KeyRule& key);
/// The names of the keys that may stand in a block.
std::vector<std::string> key_names(const BlockRule& block);

/// The names of the keys that may stand in an MTL file: "em_model".
std::vector<std::string> mtl_names(const BlockRule& block);

/// The block of a value, or of the elements of its list; null where there is none.
const BlockRule* block_of(const std::vector<ValueRule>& forms);
/// A block and all that hang from it, each once, in the order of the keys.
std::vector<const BlockRule*> blocks_from(const BlockRule& root);

/// "a number from 0 to 1 m or null"; without its unit, "a number from 0 to 1 or null".
std::string text_of(const std::vector<ValueRule>& forms, bool with_unit = true);
/// The unit of the numbers in any form; empty where there is none.
std::string unit_of(const std::vector<ValueRule>& forms);
/// "2000", "required", "one of position_m, waypoints, poses_csv", or a sentence.
std::string absence_text(const BlockRule& block, const KeyRule& key);

/// "a, b or c"; with another last word "a, b, c".
std::string enumeration(const std::vector<std::string>& words, const std::string& last = " or ");

}  // namespace dcem::io::keys
