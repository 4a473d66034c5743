#pragma once
/// The keys of a scenario, for people and for programs. All is written from the tables by which scenarios are read.
#include <string>
#include <string_view>

namespace dcem::io {

/// For a terminal: each key with its meaning, what it may be, its unit, its default and an example, block by block.
/// Those alone whose path, meaning or words hold `word`, whatever the case of its letters; empty where there are none.
std::string scenario_keys(std::string_view word = {});

/// The same as one page in Markdown.
std::string scenario_reference();

/// JSON Schema (2020-12). What it refuses is no scenario; what it admits may still contradict itself, or name files
/// that are not there.
std::string scenario_schema();

}  // namespace dcem::io
