#pragma once
/// What a folder of results holds, as far as it is the same for every run of a scenario.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "tests/io/temporary_folder.hpp"

namespace dcem::test {

/// Every file of a folder by its name. Of a summary without what a clock has measured, and without how much work it
/// was: who goes on remembers nothing.
inline std::map<std::string, std::string> files_of(const std::filesystem::path& folder) {
  static const std::regex clocked(
      R"re("((update|solve|serial|parallel|beside|longest_tasks)_time_s|real_time_factor|frame_time_[a-z0-9]+_s)": ?(null|[-+.e0-9]+))re");
  static const std::regex worked(R"re("(tree|cache|work)": ?\{[^{}]*\})re");
  std::map<std::string, std::string> files;
  if (!std::filesystem::exists(folder)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const std::string bytes = file_bytes(entry.path());
    const bool is_summary = name.ends_with("summary.json");
    files[name] = is_summary ? std::regex_replace(std::regex_replace(bytes, clocked, ""), worked, "") : bytes;
  }
  return files;
}

/// In their order. The files may hold gigabytes, and are not read.
inline std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  if (!std::filesystem::exists(folder)) return names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::ranges::sort(names);
  return names;
}

inline bool holds(const std::vector<std::string>& names, const std::string& part) {
  return std::any_of(names.begin(), names.end(),
                     [&](const std::string& name) { return name.find(part) != std::string::npos; });
}

inline void check_same_files(const std::filesystem::path& folder, const std::filesystem::path& expected) {
  CHECK(names_in(folder) == names_in(expected));
  const auto files = files_of(folder), others = files_of(expected);
  for (const auto& other : others) {
    CAPTURE(other.first);
    CHECK((files.contains(other.first) && files.at(other.first) == other.second));  // not shown: megabytes
  }
}

}  // namespace dcem::test
