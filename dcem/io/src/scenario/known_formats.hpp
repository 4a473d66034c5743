#pragma once
/// Files of other kinds that are handed over in place of a scenario. Private to dcem::io.
#include <filesystem>
#include <string>

namespace dcem::io {

/// Throws InputError that says what the file is, and where a scenario names it, where its name or its first letters
/// tell. Called with what is no JSON.
void refuse_known_format(const std::filesystem::path& file, const std::string& text);

}  // namespace dcem::io
