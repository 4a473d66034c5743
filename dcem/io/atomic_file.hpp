#pragma once
/// Result files that appear under their final name only when they are complete.
///
/// A file is written aside, in the same folder under a hidden temporary name, and renamed by `commit()`; a rename
/// within one folder is atomic, so a reader sees the old file or the whole new one. What is not committed is removed
/// by the destructor, and what a program that was killed left aside by the next `OutputFolder` there. This guards
/// against a run that fails, a full disk and a program that is killed; it does not wait for the disk (no fsync), so it
/// promises nothing about a power failure.
#include <filesystem>
#include <fstream>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace dcem::io {

/// A result could not be written. The text reads "PATH: what is wrong; what was expected".
class OutputError : public std::runtime_error {
 public:
  OutputError(const std::filesystem::path& path, const std::string& problem, const std::string& expectation);
};

/// One file, written aside and renamed by `commit()`. Can be moved, not copied. Not for use by several threads at once.
class AtomicFile {
 public:
  /// Opens the temporary file beside `target` (binary, nothing is translated).
  /// Throws `OutputError` where the folder is missing or cannot be written, or where `target` exists and is not a
  /// regular file.
  explicit AtomicFile(std::filesystem::path target);
  /// The same with the temporary file in another folder of the same file system; that of `target` may be missing until
  /// `commit()`.
  AtomicFile(std::filesystem::path target, const std::filesystem::path& aside);
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&&) = delete;
  /// Removes the temporary file unless `commit()` succeeded.
  ~AtomicFile();

  /// The stream to write to. Its errors need no check by the caller: `close()` and `commit()` throw on them.
  [[nodiscard]] std::ostream& stream() { return stream_; }

  /// Writes bytes and throws `OutputError` at once when the disk does not take them.
  void write(std::string_view bytes);

  /// Gives back the file handle until the next `write()`, for programs that write to more files than they may have
  /// open. Throws `OutputError` as `write()` does.
  void rest();

  /// Flushes, checks for errors and closes; the file stays aside. A program that collects hundreds of files calls it
  /// to give back the file handle. Calling it twice is harmless.
  void close();

  /// `close()`, then renames to the final name, replacing a file of that name. Throws `OutputError` on any failure;
  /// the final name then is as it was before.
  void commit();

  [[nodiscard]] const std::filesystem::path& target() const { return target_; }
  /// Where it is until `commit()`, for libraries that write a file by its name. They write all of it, and nothing goes
  /// to `stream()`.
  [[nodiscard]] const std::filesystem::path& aside() const { return temporary_; }

 private:
  [[noreturn]] void fail(int error_number) const;

  std::filesystem::path target_;
  std::filesystem::path temporary_;  // empty after commit() and in a moved-from object
  std::ofstream stream_;
  bool resting_ = false, closed_ = false;
};

/// Ends the program at once, without anything that else is done at its end, and removes the files that it is writing
/// and that have no name yet. None gets its name or is begun meanwhile.
[[noreturn]] void end_without_unfinished_files(int exit_code) noexcept;

class FolderClaim;

/// Several files of one folder that appear together: none has its final name before `commit()`. One object at a time,
/// of whatever process, has the folder.
/// A run that fails leaves nothing: temporary files are removed, and so are the folders that this object created, as
/// long as nothing else was put there.
class OutputFolder {
 public:
  /// Creates the folder (and its parents) where absent, removes what a program that was killed left there, and tries
  /// whether the folder can be written, so that a long run fails at its start and not at its end. Throws `OutputError`,
  /// also where another object has the folder.
  explicit OutputFolder(std::filesystem::path folder);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder();

  /// Starts the file `name` in this folder, or in one below it: "qd/nodes.csv"; those appear with the files. The
  /// reference stays valid as long as this object. Throws `std::invalid_argument` for a name that leads out of the
  /// folder or that was opened before, and `OutputError` as `AtomicFile` does.
  AtomicFile& open(const std::string& name);

  /// The names of the files opened so far, in that order.
  [[nodiscard]] std::vector<std::string> names() const;

  /// Closes and checks every file, removes those of a former result (names as `open` takes them), then renames all in
  /// the order in which they were opened. Throws `OutputError`; should a rename fail in the midst, the files of this
  /// object that already had their final name are removed, so that no partial result stays.
  void commit(const std::vector<std::string>& former = {});

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

 private:
  void create_folders();
  void remove_created_folders() noexcept;
  void make_room(const std::filesystem::path& file);
  void rename_all();

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> created_;  // outermost first
  std::unique_ptr<FolderClaim> claim_;          // given up last
  std::vector<std::unique_ptr<AtomicFile>> files_;
  bool committed_ = false;
};

}  // namespace dcem::io
