#pragma once
/// One run at a time in a folder, and what a run that was killed has left there. Private to dcem::io.
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace dcem::io {

/// Where a file is written before it has its name: hidden, in the same folder, with the number of this process and a
/// counter, so that two programs, or two files of one program, never share it. It counts as in use until it is given
/// up.
std::filesystem::path take_temporary_beside(const std::filesystem::path& target);
void give_up_temporary(const std::filesystem::path& temporary);
/// Gives it the name of what it was written for, and gives it up where that is done.
void name_temporary(const std::filesystem::path& temporary, const std::filesystem::path& target,
                    std::error_code& error);

/// Holds a folder for one run, as long as the object lives; a process that is killed lets go of it.
class FolderClaim {
 public:
  /// Throws OutputError where another run holds it. A file system that knows no locks lets everybody in.
  explicit FolderClaim(const std::filesystem::path& folder);
  FolderClaim(const FolderClaim&) = delete;
  FolderClaim& operator=(const FolderClaim&) = delete;
  ~FolderClaim();

 private:
  int descriptor_ = -1;
};

/// While files of a run take their names, their folder holds a note of all names that are touched: should the program
/// be killed then, the next run knows that these files belong to no whole result.
class CommitNote {
 public:
  /// Writes the note. Throws OutputError.
  CommitNote(const std::filesystem::path& folder, const std::vector<std::string>& names);
  CommitNote(const CommitNote&) = delete;
  CommitNote& operator=(const CommitNote&) = delete;
  /// Removes it.
  ~CommitNote();

 private:
  std::filesystem::path file_;
};

/// Removes what killed runs left in a folder: files that were written aside, of processes that are no more, and files
/// of a result that was not whole. Errors are left to whoever writes there next.
void remove_leftovers(const std::filesystem::path& folder) noexcept;

/// Removes the files of these names that are in the folder or in one below it, where they are regular files, and
/// folders below it that are empty then. Goes through no link.
void remove_files(const std::filesystem::path& folder, const std::vector<std::string>& names) noexcept;

/// Whether a text is the name of a file in a folder or below it, and no way out: "links.csv", "qd/nodes.csv".
bool is_name_inside(const std::string& name);

}  // namespace dcem::io
