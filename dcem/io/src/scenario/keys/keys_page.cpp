#include <cctype>

#include "dcem/io/scenario_keys.hpp"
#include "dcem/io/src/scenario/keys/blocks.hpp"

namespace dcem::io {

namespace {

using keys::BlockRule;
using keys::KeyRule;

constexpr const char* page_head =
    "# Every key of a scenario\n\n"
    "Written by `dcem keys --markdown` from the tables that the reader uses. The same as text: `dcem keys`, or `dcem "
    "keys "
    "WORD` for what\nhas to do with a word. For editors and validators: `dcem schema`, shipped as "
    "[data/dcem-scenario-1.schema.json](../data/dcem-scenario-1.schema.json).\n";

std::string title_of(const BlockRule& block) {
  return block.path.empty() ? "The scenario" : "`" + block.path + "`";
}

/// What a heading is called in the address of the page: letters and digits of the path.
std::string anchor_of(const BlockRule& block) {
  std::string anchor;
  for (const char letter : block.path) {
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_') anchor += letter;
  }
  return anchor;
}

std::string in_code(const std::string& text) {
  return text.empty() ? text : "`" + text + "`";
}

std::string value_cell(const KeyRule& key) {
  const BlockRule* block = keys::block_of(key.forms);
  return keys::text_of(key.forms, false) + (block == nullptr ? "" : " ([its keys](#" + anchor_of(*block) + "))");
}

std::string absence_cell(const BlockRule& block, const KeyRule& key) {
  const std::string text = keys::absence_text(block, key);
  return key.absence.kind == keys::Absence::Kind::value ? in_code(text) : text;
}

std::string row_of(const BlockRule& block, const KeyRule& key) {
  std::string row = "|";
  for (const std::string& cell : {in_code(key.name), key.meaning, value_cell(key), keys::unit_of(key.forms),
                                  absence_cell(block, key), in_code(key.example)}) {
    row += " " + cell + (cell.empty() ? "|" : " |");
  }
  return row + "\n";
}

std::string section_of(const BlockRule& block) {
  std::string text = "\n## " + title_of(block) + "\n\n" + block.meaning + "\n\n" +
                     "| key | meaning | value | unit | default | example |\n|---|---|---|---|---|---|\n";
  for (const KeyRule& key : block.keys) text += row_of(block, key);
  if (!block.mtl_prefix.empty()) {
    text += "\nIn MTL files: " + keys::enumeration(keys::mtl_names(block), ", ") + ".\n";
  }
  return text;
}

}  // namespace

std::string scenario_reference() {
  std::string page = page_head;
  for (const BlockRule* block : keys::blocks_from(keys::scenario_block())) page += section_of(*block);
  return page;
}

}  // namespace dcem::io
