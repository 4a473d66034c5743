#pragma once
/// How far long work is, as a bar for people or as JSON for programs, on the error stream so that results on the output
/// stream stay clean.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace dcem::io {

/// What is shown: a bar, `automatic` only where the error stream is a terminal; or lines of JSON (`progress_json`).
enum class ProgressMode { automatic, always, never, json };

/// One line of progress, at most 79 characters: label, bar, percentage, done/total and the time left, which is
/// `elapsed_s` · (total − done) / done (unknown, "--:--", before the first piece is done).
std::string progress_line(const std::string& label, std::uint64_t done, std::uint64_t total, double elapsed_s);

/// The same as an object on one line without its end: `{"stage":"frames","done":3,"total":100,"elapsed_s":1.5,
/// "remaining_s":48.5}`, times rounded to milliseconds. `remaining_s` is null where it is not known; so is `total`
/// where it is absent.
std::string progress_json(const std::string& stage, std::uint64_t done, std::optional<std::uint64_t> total,
                          double elapsed_s);

/// `{"warning":"…"}`, for programs that read progress.
std::string warning_json(const std::string& warning);

/// `duration_s` as "m:ss" or "h:mm:ss", rounded to whole seconds.
std::string format_duration(double duration_s);

/// Shows how far a loop of known length is. `advance()` may be called by any number of threads at once; the line is
/// drawn at most ten times a second, whatever the number of calls.
class ProgressBar {
 public:
  /// `total`: number of pieces of work; `stream` is where an `always` bar goes (tests). `automatic` looks at the
  /// process's error stream, and shows nothing on any other stream.
  ProgressBar(std::string label, std::uint64_t total, ProgressMode mode, std::ostream& stream = std::cerr);
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  /// Calls `finish()`.
  ~ProgressBar();

  /// Reports `pieces` more as done.
  void advance(std::uint64_t pieces = 1);

  /// Replaces the bar by a last line, "label: 100 of 100 in 0:12", and ends it; work that was cut short reads
  /// "label: stopped at 40 of 100 after 0:05". Of JSON the last line says what is done, once. Later calls do nothing.
  void finish();

  [[nodiscard]] std::uint64_t done() const { return done_.load(std::memory_order_relaxed); }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] double elapsed_s() const;
  void show(const std::string& line);

  const std::string label_;
  const std::uint64_t total_;
  const bool shown_, is_json_;
  std::ostream& stream_;
  const Clock::time_point start_ = Clock::now();
  std::atomic<std::uint64_t> done_{0};
  std::atomic<std::int64_t> next_draw_ns_{0};  // nanoseconds since start_
  std::mutex mutex_;                           // guards the stream and the members below
  std::size_t shown_width_ = 0;
  std::optional<std::uint64_t> shown_done_;  // by the last JSON line
  bool finished_ = false;
};

/// Shows that something goes on of which nobody knows how long it takes: "reading scene …  0:07", once a second. A line
/// for people is gone when the work is done; JSON lines stay, the last one with `done` 1.
class ProgressStage {
 public:
  ProgressStage(std::string label, ProgressMode mode, std::ostream& stream = std::cerr);
  ProgressStage(const ProgressStage&) = delete;
  ProgressStage& operator=(const ProgressStage&) = delete;
  ~ProgressStage();

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] double elapsed_s() const;
  void tell();
  void show(std::uint64_t done);

  const std::string label_;
  const bool shown_, is_json_;
  std::ostream& stream_;
  const Clock::time_point start_ = Clock::now();
  std::size_t shown_width_ = 0;
  std::mutex mutex_;  // guards `ends_`
  std::condition_variable wake_;
  bool ends_ = false;
  std::thread thread_;  // shows, from the first line to the last but one
};

}  // namespace dcem::io
