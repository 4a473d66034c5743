#include <algorithm>
#include <cctype>

#include "dcem/io/scenario_keys.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"

namespace dcem::io {

namespace {

using keys::BlockRule;
using keys::KeyRule;

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return lower;
}

std::string path_of(const BlockRule& block, const KeyRule& key) {
  return block.path.empty() ? key.name : block.path + "." + key.name;
}

std::string absence_words(keys::Absence::Kind kind) {
  if (kind == keys::Absence::Kind::value) return "default: ";
  return kind == keys::Absence::Kind::told ? "without it: " : "";
}

/// Whether a key has to do with a word in lower case: its path, its meaning, one of its own words.
bool is_about(const BlockRule& block, const KeyRule& key, const std::string& wanted) {
  std::string about = path_of(block, key) + "\n" + key.meaning;
  if (keys::fits_mtl(block, key)) about += "\n" + block.mtl_prefix + key.name;
  for (const keys::ValueRule& form : key.forms) about += "\n" + keys::enumeration(form.words, "\n");
  return lower_case(about).find(wanted) != std::string::npos;
}

/// A key in three lines: what it is called, what it means, what it may be.
std::string key_text(const BlockRule& block, const KeyRule& key) {
  std::string text = "  " + path_of(block, key);
  if (keys::fits_mtl(block, key)) text += "  (MTL: " + block.mtl_prefix + key.name + ")";
  text += "\n      " + key.meaning + "\n      " + keys::text_of(key.forms);
  text += "; " + absence_words(key.absence.kind) + keys::absence_text(block, key);
  return text + (key.example.empty() ? "" : "; e.g. " + key.example) + "\n";
}

}  // namespace

std::string scenario_keys(std::string_view word) {
  const std::string wanted = lower_case(word);
  std::string text;
  for (const BlockRule* block : keys::blocks_from(keys::scenario_block())) {
    std::string found;
    for (const KeyRule& key : block->keys) {
      if (is_about(*block, key, wanted)) found += key_text(*block, key);
    }
    if (found.empty()) continue;
    const std::string title = block->path.empty() ? "scenario" : block->path;
    text += (text.empty() ? "" : "\n") + title + ": " + block->meaning + "\n" + found;
  }
  return text;
}

}  // namespace dcem::io
