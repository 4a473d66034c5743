#pragma once
/// What every benchmark does: read its arguments, run, and say how it ended.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <string>

namespace dcem::bench {

/// Exit status: 0 done, 1 where `run() -> bool` says that results differ, 2 for bad usage or bad input.
template <typename Run>
int run_program(CLI::App& app, int count, char** arguments, Run&& run) {
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    return run() ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}

/// Milliseconds since it was made.
class Stopwatch {
 public:
  double elapsed_ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// One line of a CSV file, cell by cell; text cells hold no comma.
class CsvRow {
 public:
  CsvRow& text(const std::string& cell) {
    line_ += (line_.empty() ? "" : ",") + cell;
    return *this;
  }
  CsvRow& count(std::uint64_t value) { return text(std::to_string(value)); }
  CsvRow& number(double value, int decimals) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "%.*f", decimals, value);
    return text(buffer);
  }
  CsvRow& hash(std::uint64_t value) {
    char buffer[32];
    std::snprintf(buffer, sizeof buffer, "%016llx", static_cast<unsigned long long>(value));
    return text(buffer);
  }
  /// Nothing where there is nothing to say.
  CsvRow& empty() { return text(""); }
  /// To standard output, at once: long benchmarks are tracked.
  void print() const {
    std::puts(line_.c_str());
    std::fflush(stdout);
  }

 private:
  std::string line_;
};

}  // namespace dcem::bench
