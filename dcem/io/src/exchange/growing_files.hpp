#pragma once
/// Many files that grow side by side, more than a program may have open. Private to dcem::io.
#include <cstddef>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"

namespace dcem::io {

/// Text is gathered for all of them, and handed over file by file when there is much of it.
class GrowingFiles {
 public:
  explicit GrowingFiles(OutputFolder& folder) : folder_(folder) {}

  /// Starts a file; returns its number. Throws `OutputError`.
  std::size_t open(const std::string& name);
  /// Appends. Throws `OutputError`.
  void append(std::size_t file, const std::string& text);
  /// Hands over what is left, and closes all. Throws `OutputError`.
  void close();

 private:
  void hand_over();

  struct Sheet {
    AtomicFile* file = nullptr;
    std::string text{};
  };

  OutputFolder& folder_;
  std::vector<Sheet> sheets_;
  std::size_t waiting_bytes_ = 0;
};

}  // namespace dcem::io
