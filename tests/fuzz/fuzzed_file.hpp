#pragma once
/// What fuzz targets share: bytes become a file, and reading it ends in a result or in an InputError. Anything else, an
/// exception of another kind among it, ends the program, which is what the fuzzer looks for.
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "dcem/io/input_error.hpp"

namespace dcem::fuzz {

/// A folder of one process, removed at its end; in memory where the machine has such a place.
class WorkFolder {
 public:
  WorkFolder() {
    const std::filesystem::path memory = "/dev/shm";
    const std::filesystem::path parent =
        std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
    path_ = parent / ("dcem-fuzz-" + std::to_string(::getpid()));
    std::filesystem::create_directories(path_);
  }
  ~WorkFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    const std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return file;
  }
  /// Copies the files of a folder of good input.
  void copy_from(const std::filesystem::path& folder) const {
    std::filesystem::copy(folder, path_, std::filesystem::copy_options::overwrite_existing);
  }

 private:
  std::filesystem::path path_;
};

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// The first line names what the rest is, where a target reads several kinds of files.
inline std::string_view take_line(std::string_view& bytes) {
  const std::size_t end = bytes.find('\n');
  const std::string_view line = bytes.substr(0, end);
  bytes = end == std::string_view::npos ? std::string_view{} : bytes.substr(end + 1);
  return line;
}

/// Runs a reader; bad input is what it is there to refuse.
template <typename Read>
int expect_result_or_input_error(Read&& read) {
  try {
    read();
  } catch (const io::InputError&) {
  }
  return 0;
}

}  // namespace dcem::fuzz
