#include "dcem/io/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dcem/io/text_table.hpp"

namespace dcem::io {
namespace {

constexpr std::int64_t draw_interval_ns = 100'000'000;
constexpr std::size_t bar_width = 20;
constexpr std::size_t line_width = 79;

bool is_shown(ProgressMode mode, const std::ostream& stream) {
  if (mode == ProgressMode::automatic) return &stream == &std::cerr && ::isatty(STDERR_FILENO) == 1;
  return mode == ProgressMode::always;
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
  const bool rate_known = done > 0 && total >= done;
  const double left_s = rate_known ? elapsed_s * static_cast<double>(total - done) / static_cast<double>(done) : 0.0;
  // The percentage is cut, not rounded: 100 % stands there only when all is done.
  std::string percentage = std::to_string(static_cast<int>(share * 100.0));
  percentage.insert(0, 3 - percentage.size(), ' ');
  const std::string tail = "  [" + std::string(filled, '#') + std::string(bar_width - filled, '.') + "] " + percentage +
                           " %  " + std::to_string(done) + "/" + std::to_string(total) + "  " +
                           (rate_known ? format_duration(left_s) : "--:--") + " left";
  const std::size_t label_width = tail.size() < line_width ? line_width - tail.size() : 0;
  return cut_to_width(label, label_width) + tail;
}

ProgressBar::ProgressBar(std::string label, std::uint64_t total, ProgressMode mode, std::ostream& stream)
    : label_(std::move(label)), total_(total), shown_(is_shown(mode, stream)), stream_(stream) {}

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
  const std::string count = std::to_string(done()) + " of " + std::to_string(total_);
  const std::string duration = format_duration(elapsed_s());
  show(done() >= total_ ? label_ + ": " + count + " in " + duration
                        : label_ + ": stopped at " + count + " after " + duration);
  stream_ << '\n' << std::flush;
}

// Blanks wipe out what a longer line before left; plain text keeps log files and simple terminals readable.
void ProgressBar::show(const std::string& line) {
  const std::size_t width = character_count(line);
  const std::size_t rest = shown_width_ > width ? shown_width_ - width : 0;
  stream_ << '\r' << line << std::string(rest, ' ') << std::flush;
  shown_width_ = width;
}

}  // namespace dcem::io
