#include "stop_signal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <string_view>
#include <system_error>
#include <thread>

#include "dcem/io/atomic_file.hpp"

namespace dcem::program {
namespace {

std::atomic<bool> is_awaited = false, is_ending = false;
std::atomic<int> received = 0;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler may touch nothing else");

bool is_watched = false;  ///< somebody sits at a terminal; known before signals come
int to_ender = -1;        ///< what a thread of its own reads, which ends the program; known before signals come

extern "C" void on_stop_signal(int signal) {
  if (!is_awaited || received != 0) {
    const auto number = static_cast<char>(signal);
    // Where files cannot be removed, or nobody listens, one signal more ends the program as it is.
    if (is_ending.exchange(true) || to_ender < 0 || ::write(to_ender, &number, 1) != 1) ::_exit(128 + signal);
    return;
  }
  received = signal;
  constexpr std::string_view word = "\nending when what is begun is done; a second signal ends at once\n";
  if (is_watched && ::write(STDERR_FILENO, word.data(), word.size()) < 0) return;  // then nobody hears of it
}

/// A signal handler must not look for what is half written.
void end_when_told(int from_handler) {
  char number = SIGTERM;
  while (::read(from_handler, &number, 1) < 0 && errno == EINTR) {
  }
  io::end_without_unfinished_files(128 + number);
}

/// Without the thread, where the system gives none, hidden files stay until the next run in their folder.
void begin_to_listen() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return;
  try {
    std::thread(end_when_told, ends[0]).detach();
    to_ender = ends[1];
  } catch (const std::system_error&) {
    ::close(ends[0]);
    ::close(ends[1]);
  }
}

}  // namespace

void end_on_signals() {
  is_watched = ::isatty(STDERR_FILENO) == 1;
  begin_to_listen();
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction action {};
    if (::sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = &on_stop_signal;
    action.sa_flags = SA_RESTART;
    ::sigaction(signal, &action, nullptr);
  }
}

StopRequest::StopRequest() {
  received = 0;
  is_awaited = true;
}

StopRequest::~StopRequest() {
  is_awaited = false;
}

int StopRequest::signal() const {
  return received;
}

std::string signal_name(int signal) {
  return signal == SIGINT ? "SIGINT" : "SIGTERM";
}

}  // namespace dcem::program
