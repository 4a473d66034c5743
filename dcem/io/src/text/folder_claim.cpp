#include "dcem/io/src/text/folder_claim.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <fstream>
#include <mutex>
#include <optional>
#include <set>
#include <string_view>
#include <system_error>

#include "dcem/io/atomic_file.hpp"

namespace dcem::io {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view temporary_ending = ".part";
constexpr const char* note_name = ".dcem-commit";

/// The temporary files of this process that are in use.
struct Temporaries {
  std::mutex mutex;
  std::set<fs::path> paths;
  unsigned counter = 0;
};

Temporaries& temporaries() {
  static Temporaries all;
  return all;
}

/// Of ".links.csv.4711-0.part" 4711; nothing where the name is not of this kind.
std::optional<pid_t> writer_of(std::string_view name) {
  if (!name.starts_with('.') || !name.ends_with(temporary_ending)) return std::nullopt;
  name.remove_suffix(temporary_ending.size());
  const std::size_t dot = name.rfind('.');
  if (dot == 0 || dot == std::string_view::npos) return std::nullopt;
  const char* const end = name.data() + name.size();
  pid_t writer = 0;
  unsigned number = 0;
  const auto [dash, error] = std::from_chars(name.data() + dot + 1, end, writer);
  if (error != std::errc{} || dash == end || *dash != '-' || writer <= 0) return std::nullopt;
  const auto [rest, number_error] = std::from_chars(dash + 1, end, number);
  return number_error == std::errc{} && rest == end ? std::optional(writer) : std::nullopt;
}

bool is_in_use(const fs::path& temporary, pid_t writer) {
  if (writer != ::getpid()) return ::kill(writer, 0) == 0 || errno != ESRCH;
  Temporaries& all = temporaries();
  const std::lock_guard<std::mutex> lock(all.mutex);
  return all.paths.contains(temporary);
}

void remove_unfinished_result(const fs::path& folder) {
  std::vector<std::string> names;
  {
    std::ifstream note(folder / note_name);
    for (std::string name; std::getline(note, name);) names.push_back(name);
  }
  remove_files(folder, names);
  std::error_code ignored;
  fs::remove(folder / note_name, ignored);
}

bool leads_through_link(const fs::path& folder, const fs::path& name) {
  for (fs::path above = name.parent_path(); !above.empty(); above = above.parent_path()) {
    std::error_code error;
    if (!fs::is_directory(fs::symlink_status(folder / above, error))) return true;
  }
  return false;
}

void remove_temporaries(const fs::path& folder) {
  std::vector<fs::path> dead;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const std::optional<pid_t> writer = writer_of(entry->path().filename().string());
    if (writer && !is_in_use(entry->path(), *writer)) dead.push_back(entry->path());
  }
  for (const fs::path& file : dead) fs::remove(file, error);
}

}  // namespace

fs::path take_temporary_beside(const fs::path& target) {
  Temporaries& all = temporaries();
  const std::lock_guard<std::mutex> lock(all.mutex);
  const std::string suffix =
      "." + std::to_string(::getpid()) + "-" + std::to_string(all.counter++) + std::string(temporary_ending);
  return *all.paths.insert(target.parent_path() / ("." + target.filename().string() + suffix)).first;
}

void give_up_temporary(const fs::path& temporary) {
  Temporaries& all = temporaries();
  const std::lock_guard<std::mutex> lock(all.mutex);
  all.paths.erase(temporary);
}

void name_temporary(const fs::path& temporary, const fs::path& target, std::error_code& error) {
  Temporaries& all = temporaries();
  const std::lock_guard<std::mutex> lock(all.mutex);
  fs::rename(temporary, target, error);
  if (!error) all.paths.erase(temporary);
}

void end_without_unfinished_files(int exit_code) noexcept {
  Temporaries& all = temporaries();
  all.mutex.lock();  // for good
  std::error_code ignored;
  for (const fs::path& file : all.paths) fs::remove(file, ignored);
  ::_exit(exit_code);
}

FolderClaim::FolderClaim(const fs::path& folder)
    : descriptor_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (descriptor_ < 0 || ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  throw OutputError(folder, "another run is writing there", "a folder of its own, or to wait for its end");
}

FolderClaim::~FolderClaim() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

CommitNote::CommitNote(const fs::path& folder, const std::vector<std::string>& names) : file_(folder / note_name) {
  AtomicFile note(file_);
  for (const std::string& name : names) note.write(name + '\n');
  note.commit();
}

CommitNote::~CommitNote() {
  std::error_code ignored;
  fs::remove(file_, ignored);
}

void remove_leftovers(const fs::path& folder) noexcept {
  try {
    if (std::error_code ignored; fs::exists(folder / note_name, ignored)) remove_unfinished_result(folder);
    remove_temporaries(folder);
  } catch (const std::exception&) {
    // No memory for a list of names; the next run will have it.
  }
}

void remove_files(const fs::path& folder, const std::vector<std::string>& names) noexcept {
  for (const std::string& name : names) {
    std::error_code error;
    if (!is_name_inside(name) || leads_through_link(folder, name)) continue;
    if (!fs::is_regular_file(fs::symlink_status(folder / name, error))) continue;
    fs::remove(folder / name, error);
    for (fs::path above = fs::path(name).parent_path(); !above.empty(); above = above.parent_path()) {
      if (!fs::remove(folder / above, error) || error) break;  // a folder that is not empty stays
    }
  }
}

bool is_name_inside(const std::string& name) {
  const fs::path path(name);
  if (path.empty() || path.is_absolute() || !path.has_filename() || path.lexically_normal().string() != name)
    return false;
  return std::none_of(path.begin(), path.end(), [](const fs::path& part) { return part == "." || part == ".."; });
}

}  // namespace dcem::io
