#pragma once
/// Files that are read before they are written. Private to dcem::io.
#include <filesystem>
#include <map>
#include <string>

namespace dcem::io {

/// While the object lives, this thread reads these texts, by the names that they are going to have, as if they were
/// files: what is about to be written can be tried by the reader that it is for. One object at a time.
class UnwrittenFiles {
 public:
  using Texts = std::map<std::filesystem::path, std::string>;

  explicit UnwrittenFiles(Texts&& texts);
  UnwrittenFiles(const UnwrittenFiles&) = delete;
  UnwrittenFiles& operator=(const UnwrittenFiles&) = delete;
  ~UnwrittenFiles();

  /// The text of a file, for whoever is about to open it; null where it is none of these.
  static const std::string* find(const std::filesystem::path& file);

 private:
  Texts texts_;  ///< by normal names
};

}  // namespace dcem::io
