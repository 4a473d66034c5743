#pragma once
/// The program `dcem` while it runs: its error stream is followed, and signals are sent at chosen moments.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <vector>

#include "tests/io/temporary_folder.hpp"

namespace dcem::test {

class RunningProgram {
 public:
  /// Starts it in a folder, without a standard output.
  RunningProgram(const TemporaryFolder& folder, std::vector<std::string> arguments) {
    int ends[2] = {-1, -1};
    REQUIRE(::pipe(ends) == 0);
    process_ = ::fork();
    REQUIRE(process_ >= 0);
    if (process_ == 0) become_program(folder, std::move(arguments), ends);
    ::close(ends[1]);
    error_ = ends[0];
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;
  ~RunningProgram() {
    if (process_ > 0) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
    ::close(error_);
  }

  /// Reads the error stream until what was said fits; false where it ends before.
  template <typename Fits>
  bool wait_until(Fits&& fits) {
    while (!fits(said_)) {
      if (!read_more()) return false;
    }
    return true;
  }
  /// Until it holds a text.
  bool wait_for(const std::string& text) {
    return wait_until([&](const std::string& said) { return said.find(text) != std::string::npos; });
  }

  void send(int signal) const { ::kill(process_, signal); }

  /// Waits for its end: the exit code, or 1000 and the signal that ended it.
  int end() {
    while (read_more()) {
    }
    int status = 0;
    rusage used{};
    ::wait4(process_, &status, 0, &used);
    process_ = -1;
    peak_bytes_ = 1024.0 * static_cast<double>(used.ru_maxrss);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  }

  /// The most memory that it had, known at its end.
  double peak_bytes() const { return peak_bytes_; }
  const std::string& said() const { return said_; }
  std::string last_line() const {
    const std::string text = said_.substr(0, said_.empty() ? 0 : said_.size() - 1);
    return text.substr(text.rfind('\n') + 1);
  }

 private:
  [[noreturn]] static void become_program(const TemporaryFolder& folder, std::vector<std::string> arguments,
                                          const int (&ends)[2]) {
    arguments.insert(arguments.begin(), DCEM_PROGRAM);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
    ::dup2(ends[1], STDERR_FILENO);
    ::dup2(::open("/dev/null", O_WRONLY), STDOUT_FILENO);
    ::close(ends[0]);
    ::close(ends[1]);
    if (::chdir(folder.path().c_str()) == 0) ::execv(DCEM_PROGRAM, pointers.data());
    ::_exit(126);
  }

  bool read_more() {
    char block[4096];
    const ssize_t count = ::read(error_, block, sizeof block);
    if (count > 0) said_.append(block, static_cast<std::size_t>(count));
    return count > 0;
  }

  pid_t process_ = -1;
  int error_ = -1;
  double peak_bytes_ = 0.0;
  std::string said_;
};

}  // namespace dcem::test
