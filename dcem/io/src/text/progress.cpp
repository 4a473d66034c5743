#include "dcem/io/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

constexpr std::int64_t draw_interval_ns = 100'000'000;
constexpr std::size_t bar_width = 20;
constexpr std::size_t line_width = 79;

bool is_shown(ProgressMode mode, const std::ostream& stream) {
  if (mode == ProgressMode::automatic) return &stream == &std::cerr && ::isatty(STDERR_FILENO) == 1;
  return mode == ProgressMode::always || mode == ProgressMode::json;
}

// What the rest takes at the pace so far; nothing where there is no pace yet, or more is done than was announced.
std::optional<double> remaining_s(std::uint64_t done, std::uint64_t total, double elapsed_s) {
  if (done == 0 || done > total) return std::nullopt;
  return elapsed_s * static_cast<double>(total - done) / static_cast<double>(done);
}

std::string milliseconds_text(std::optional<double> duration_s) {
  if (!duration_s) return "null";
  std::array<char, 32> text{};
  const double bounded_s = std::clamp(*duration_s, 0.0, 3.6e9);
  return {text.data(),
          std::to_chars(text.data(), text.data() + text.size(), bounded_s, std::chars_format::fixed, 3).ptr};
}

std::string two_digits(std::int64_t number) {
  return (number < 10 ? "0" : "") + std::to_string(number);
}

// Cuts at the start of a character, never inside one.
std::string cut_to_width(std::string text, std::size_t width) {
  while (character_count(text) > width) {
    while ((static_cast<unsigned char>(text.back()) & 0xC0U) == 0x80U) text.pop_back();
    text.pop_back();
  }
  return text;
}

}  // namespace

std::string format_duration(double duration_s) {
  const double bounded_s = std::isfinite(duration_s) ? std::clamp(duration_s, 0.0, 3.6e9) : 0.0;
  const std::int64_t seconds = std::llround(bounded_s);
  const std::string tail = two_digits(seconds % 60);
  if (seconds < 3600) return std::to_string(seconds / 60) + ":" + tail;
  return std::to_string(seconds / 3600) + ":" + two_digits(seconds / 60 % 60) + ":" + tail;
}

std::string progress_line(const std::string& label, std::uint64_t done, std::uint64_t total, double elapsed_s) {
  const double share = total == 0 ? 1.0 : std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  const auto filled = static_cast<std::size_t>(share * static_cast<double>(bar_width));
  const std::optional<double> left_s = remaining_s(done, total, elapsed_s);
  // The percentage is cut, not rounded: 100 % stands there only when all is done.
  std::string percentage = std::to_string(static_cast<int>(share * 100.0));
  percentage.insert(0, 3 - percentage.size(), ' ');
  const std::string tail = "  [" + std::string(filled, '#') + std::string(bar_width - filled, '.') + "] " + percentage +
                           " %  " + std::to_string(done) + "/" + std::to_string(total) + "  " +
                           (left_s ? format_duration(*left_s) : "--:--") + " left";
  const std::size_t label_width = tail.size() < line_width ? line_width - tail.size() : 0;
  return cut_to_width(label, label_width) + tail;
}

std::string progress_json(const std::string& stage, std::uint64_t done, std::optional<std::uint64_t> total,
                          double elapsed_s) {
  const std::optional<double> left_s = total ? remaining_s(done, *total, elapsed_s) : std::nullopt;
  return "{\"stage\":\"" + stage + "\",\"done\":" + std::to_string(done) +
         ",\"total\":" + (total ? std::to_string(*total) : "null") + ",\"elapsed_s\":" + milliseconds_text(elapsed_s) +
         ",\"remaining_s\":" + milliseconds_text(left_s) + "}";
}

std::string warning_json(const std::string& warning) {
  return nlohmann::json{{"warning", warning}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

ProgressBar::ProgressBar(std::string label, std::uint64_t total, ProgressMode mode, std::ostream& stream)
    : label_(std::move(label)),
      total_(total),
      shown_(is_shown(mode, stream)),
      is_json_(mode == ProgressMode::json),
      stream_(stream) {
  if (!shown_) return;
  // The first piece may take long. Programs hear of it at once, people with the next line that is due.
  show(progress_line(label_, 0, total_, 0.0));
  if (!is_json_) next_draw_ns_ = draw_interval_ns;
}

ProgressBar::~ProgressBar() {
  finish();
}

double ProgressBar::elapsed_s() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void ProgressBar::advance(std::uint64_t pieces) {
  done_.fetch_add(pieces, std::memory_order_relaxed);
  if (!shown_) return;
  const std::int64_t now_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - start_).count();
  std::int64_t due_ns = next_draw_ns_.load(std::memory_order_relaxed);
  // Of the threads that find the line due, the one that moves the due time draws it.
  if (now_ns < due_ns || !next_draw_ns_.compare_exchange_strong(due_ns, now_ns + draw_interval_ns)) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!finished_) show(progress_line(label_, done(), total_, elapsed_s()));
}

void ProgressBar::finish() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!shown_ || std::exchange(finished_, true)) return;
  if (is_json_) {
    if (shown_done_ != done()) show({});  // the last piece may have been told already
    return;
  }
  const std::string count = std::to_string(done()) + " of " + std::to_string(total_);
  const std::string duration = format_duration(elapsed_s());
  show(done() >= total_ ? label_ + ": " + count + " in " + duration
                        : label_ + ": stopped at " + count + " after " + duration);
  stream_ << '\n' << std::flush;
}

// Blanks wipe out what a longer line before left; plain text keeps log files and simple terminals readable.
void ProgressBar::show(const std::string& line) {
  if (is_json_) {
    shown_done_ = done();
    stream_ << progress_json(label_, *shown_done_, total_, elapsed_s()) + '\n' << std::flush;
    return;
  }
  const std::size_t width = character_count(line);
  const std::size_t rest = shown_width_ > width ? shown_width_ - width : 0;
  stream_ << '\r' << line << std::string(rest, ' ') << std::flush;
  shown_width_ = width;
}

ProgressStage::ProgressStage(std::string label, ProgressMode mode, std::ostream& stream)
    : label_(std::move(label)), shown_(is_shown(mode, stream)), is_json_(mode == ProgressMode::json), stream_(stream) {
  if (!shown_) return;
  show(0);
  try {
    thread_ = std::thread([this] { tell(); });
  } catch (const std::system_error&) {
    // The system gives no thread: the first line has to do.
  }
}

ProgressStage::~ProgressStage() {
  if (!shown_) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (is_json_) {
    show(1);
    return;
  }
  stream_ << '\r' << std::string(shown_width_, ' ') << '\r' << std::flush;
}

double ProgressStage::elapsed_s() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void ProgressStage::tell() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!wake_.wait_for(lock, std::chrono::seconds(1), [this] { return ends_; })) show(0);
}

void ProgressStage::show(std::uint64_t done) {
  if (is_json_) {
    stream_ << progress_json(label_, done, 1, elapsed_s()) + '\n' << std::flush;
    return;
  }
  const std::string line = label_ + " ...  " + format_duration(elapsed_s());
  shown_width_ = std::max(shown_width_, character_count(line));
  stream_ << '\r' << line << std::flush;
}

}  // namespace dcem::io
