#pragma once
/// Which files were read for something. Private to dcem::io.
#include <filesystem>
#include <vector>

namespace dcem::io {

/// Remembers the files that this thread opens for reading while the object lives, each once, in order. Of several
/// objects each has those of its own time.
class ReadLog {
 public:
  ReadLog();
  ReadLog(const ReadLog&) = delete;
  ReadLog& operator=(const ReadLog&) = delete;
  ~ReadLog();

  const std::vector<std::filesystem::path>& files() const { return files_; }

  /// Called by whoever opens a file.
  static void note(const std::filesystem::path& file);

 private:
  ReadLog* const outer_;
  std::vector<std::filesystem::path> files_;
};

}  // namespace dcem::io
