#include "dcem/io/atomic_file.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

#include "dcem/io/src/text/folder_claim.hpp"

namespace dcem::io {
namespace {

namespace fs = std::filesystem;

std::string describe(int error_number) {
  if (error_number == 0) return "could not be written to its end";
  return "cannot be written (" + std::generic_category().message(error_number) + ")";
}

void check_target(const fs::path& target) {
  if (!target.has_filename()) throw OutputError(target, "is no file name", "the name of a file to write");
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (fs::is_directory(status)) throw OutputError(target, "is a folder", "the name of a file to write");
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw OutputError(target, "is not a regular file", "the name of a file to write");
  }
}

}  // namespace

OutputError::OutputError(const fs::path& path, const std::string& problem, const std::string& expectation)
    : std::runtime_error(path.string() + ": " + problem + "; expected " + expectation) {}

AtomicFile::AtomicFile(fs::path target) : AtomicFile(target, target.parent_path()) {}

AtomicFile::AtomicFile(fs::path target, const fs::path& aside) : target_(std::move(target)) {
  check_target(target_);
  const fs::path temporary = take_temporary_beside(aside / target_.filename());
  errno = 0;
  stream_.open(temporary, std::ios::binary | std::ios::trunc);
  if (!stream_) {
    const int error_number = errno;
    give_up_temporary(temporary);
    fail(error_number);
  }
  temporary_ = temporary;
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::exchange(other.temporary_, {})),
      stream_(std::move(other.stream_)),
      resting_(other.resting_),
      closed_(std::exchange(other.closed_, true)) {}

AtomicFile::~AtomicFile() {
  if (temporary_.empty()) return;
  stream_.close();
  std::error_code ignored;
  fs::remove(temporary_, ignored);
  give_up_temporary(temporary_);
}

void AtomicFile::fail(int error_number) const {
  throw OutputError(target_, describe(error_number), "a folder that can be written, with space left");
}

void AtomicFile::write(std::string_view bytes) {
  errno = 0;
  if (std::exchange(resting_, false)) stream_.open(temporary_, std::ios::binary | std::ios::app);
  if (!stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail(errno);
}

void AtomicFile::rest() {
  if (closed_ || resting_) return;
  close();
  closed_ = false;
  resting_ = true;
}

void AtomicFile::close() {
  if (closed_) return;
  if (resting_) return void(closed_ = true);
  errno = 0;
  const bool written = static_cast<bool>(stream_.flush());
  const int error_number = errno;
  stream_.close();
  // A stream that failed stays failed: the next close() or commit() must not take the file for complete.
  if (!written || !stream_) fail(error_number);
  closed_ = true;
}

void AtomicFile::commit() {
  if (temporary_.empty()) return;
  close();
  std::error_code error;
  name_temporary(temporary_, target_, error);
  if (error) fail(error.value());
  temporary_.clear();
}

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  if (folder_.empty()) folder_ = ".";
  try {
    create_folders();
    claim_ = std::make_unique<FolderClaim>(folder_);
    remove_leftovers(folder_);
    const AtomicFile probe(folder_ / "dcem-probe");
  } catch (...) {
    remove_created_folders();
    throw;
  }
}

OutputFolder::~OutputFolder() {
  files_.clear();
  if (!committed_) remove_created_folders();
}

AtomicFile& OutputFolder::open(const std::string& name) {
  if (!is_name_inside(name)) {
    throw std::invalid_argument("OutputFolder: '" + name + "' is not the name of a file in the folder");
  }
  const fs::path target = folder_ / name;
  const bool known =
      std::any_of(files_.begin(), files_.end(), [&](const auto& file) { return file->target() == target; });
  if (known) throw std::invalid_argument("OutputFolder: '" + name + "' was opened before");
  for (fs::path above = fs::path(name).parent_path(); !above.empty(); above = above.parent_path()) {
    std::error_code ignored;
    const fs::file_status status = fs::symlink_status(folder_ / above, ignored);
    if (!fs::exists(status) || fs::is_directory(status)) continue;
    throw OutputError(folder_ / above, "is not a folder", "a folder, or nothing");
  }
  files_.push_back(std::make_unique<AtomicFile>(target, folder_));
  return *files_.back();
}

std::vector<std::string> OutputFolder::names() const {
  std::vector<std::string> names;
  for (const auto& file : files_)
    names.push_back(fs::path(file->target()).lexically_relative(folder_).generic_string());
  return names;
}

void OutputFolder::commit(const std::vector<std::string>& former) {
  for (const auto& file : files_) file->close();
  std::vector<std::string> touched = names();
  touched.insert(touched.end(), former.begin(), former.end());
  const CommitNote note(folder_, touched);
  // Before the first new name: a folder never holds files of two results. The last file, the summary, says of what it
  // is.
  remove_files(folder_, former);
  rename_all();
  committed_ = true;
}

/// Creates the folders of a file below this one.
void OutputFolder::make_room(const fs::path& file) {
  if (file.parent_path() == folder_) return;
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error)
    throw OutputError(file.parent_path(), "cannot be created (" + error.message() + ")", "a folder for results");
}

void OutputFolder::rename_all() {
  std::size_t renamed = 0;
  try {
    for (; renamed < files_.size(); ++renamed) {
      make_room(files_[renamed]->target());
      files_[renamed]->commit();
    }
  } catch (...) {
    std::vector<std::string> taken = names();
    taken.resize(renamed);
    remove_files(folder_, taken);
    throw;
  }
}

void OutputFolder::create_folders() {
  std::vector<fs::path> missing;
  std::error_code error;
  for (fs::path path = fs::absolute(folder_).lexically_normal(); !path.empty() && !fs::exists(path, error);
       path = path.parent_path()) {
    missing.push_back(path);
    if (path == path.parent_path()) break;
  }
  std::reverse(missing.begin(), missing.end());
  for (const fs::path& path : missing) {
    // A trailing separator yields the same folder twice; the second time nothing is created.
    if (fs::create_directory(path, error)) created_.push_back(path);
    if (error) throw OutputError(folder_, "cannot be created (" + error.message() + ")", "a place that can be written");
  }
  if (!fs::is_directory(folder_, error)) throw OutputError(folder_, "is not a folder", "a folder for the results");
}

void OutputFolder::remove_created_folders() noexcept {
  std::error_code ignored;
  for (auto path = created_.rbegin(); path != created_.rend(); ++path) fs::remove(*path, ignored);
}

}  // namespace dcem::io
