#pragma once
/// The journal of a run: what each frame brought, written as it goes, so that a run that was ended goes on where it
/// was. docs/design/long_runs.md has the reasons.
///
/// A journal belongs to the program and the machine that wrote it. It is one file, which only grows, frame by frame;
/// what was not written to its end, because the program was killed, is found out and left out.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/link_lines.hpp"
#include "dcem/io/summary.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem {

class Beside;
class ThreadPool;

}  // namespace dcem

namespace dcem::io {

/// The name of the file within the folder of results.
inline constexpr std::string_view journal_name = "run.journal";

/// A number that differs where the bytes or the number of these files do. Throws InputError where one cannot be read.
std::uint64_t content_hash(std::span<const std::filesystem::path> files);

/// What must be the same for a run to go on.
struct RunIdentity {
  std::string version;       ///< of the program
  std::uint64_t inputs = 0;  ///< `content_hash` of the scenario and of all files it names
  std::string options;       ///< those that change results, on one line

  friend bool operator==(const RunIdentity&, const RunIdentity&) = default;
  /// All of it as one short text.
  [[nodiscard]] std::string text() const;
};

/// A frame. Where `links.csv` is all that is asked for, its lines are kept instead of the links.
struct JournalEntry {
  FrameFigures figures;
  std::string link_lines;
  std::vector<LinkRequest> line_links;  ///< of each line, which link it is of
  std::vector<LinkResult> links;

  /// The result as it was. Takes the links.
  FrameResult take_result();
};

/// Writes a journal.
class RunJournal {
 public:
  /// Starts a journal, in place of one that is there. With the threads of `pool` frames are written beside what the
  /// caller does next. Throws `OutputError`.
  RunJournal(const std::filesystem::path& folder, const RunIdentity& identity, ThreadPool* pool = nullptr);
  /// Goes on behind the first `bytes` of the one that is there. Throws `OutputError`.
  RunJournal(const std::filesystem::path& folder, std::uint64_t bytes, ThreadPool* pool = nullptr);
  RunJournal(const RunJournal&) = delete;
  RunJournal& operator=(const RunJournal&) = delete;
  /// Removes a journal that was started here, unless it is kept: a run that fails leaves nothing.
  ~RunJournal();

  /// Appends a frame; it is there, should the program be killed, as soon as this returns, with threads as soon as
  /// `wait` or the next `add` does. Throws `OutputError`, be it of the frame before.
  void add(const FrameResult& frame);
  /// The same with the lines of `links.csv` in place of the links.
  void add(const FrameFigures& figures, std::span<const LinkResult> links, const LinePieces& lines);
  /// Until all frames are there. Throws `OutputError`.
  void wait();

  /// For `--resume`: the file stays when this object goes, if a frame is in it.
  void keep();
  /// When the run is whole.
  void remove();

 private:
  ThreadPool& pool() { return pool_ != nullptr ? *pool_ : *alone_; }
  void begin(std::span<const std::string> head);
  void settle();
  void write(std::string_view bytes);
  void end_frame();

  std::filesystem::path file_;
  std::ofstream stream_;
  bool is_kept_, has_frames_ = false;
  ThreadPool* pool_;
  std::unique_ptr<ThreadPool> alone_;
  std::unique_ptr<Beside> writing_;
};

/// What a journal is read for. What is to be resumed is looked at as a whole before, because it may have been cut
/// anywhere; what is to be merged is whole, and read once.
enum class JournalUse : std::uint8_t { resume, merge };

/// Reads a journal.
class JournalReader {
 public:
  /// Throws InputError where there is no journal, and where it is that of another run: `scenario` is the file that is
  /// named then.
  JournalReader(const std::filesystem::path& folder, const RunIdentity& identity, const std::string& scenario,
                JournalUse use = JournalUse::resume);

  /// Whole frames in it.
  std::size_t frames() const { return frames_; }
  /// Up to the end of the last of them.
  std::uint64_t bytes() const { return bytes_; }
  /// The next one; nothing behind the last. Throws InputError where the file has changed meanwhile.
  std::optional<JournalEntry> next();
  /// The figures of the next one, whose links or lines are passed over unread; otherwise as `next`.
  std::optional<FrameFigures> pass();

 private:
  struct PieceHead {
    char kind = 0;
    std::uint64_t size = 0, hash = 0;
  };
  struct Piece {
    char kind = 0;
    std::string bytes;
  };

  void check_head(const RunIdentity& identity, const std::string& scenario, JournalUse use);
  void count_frames(JournalUse use);
  std::optional<PieceHead> next_head();
  std::optional<Piece> next_piece();
  std::optional<Piece> rest_of(const PieceHead& head);
  bool pass_over(const PieceHead& head);
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t size_ = 0, bytes_ = 0;
  std::size_t frames_ = 0, read_ = 0;
};

}  // namespace dcem::io
