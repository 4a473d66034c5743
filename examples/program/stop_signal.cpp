#include "stop_signal.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <string_view>

namespace dcem::program {
namespace {

std::atomic<bool> is_awaited = false;
std::atomic<int> received = 0;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free,
              "a signal handler may touch nothing else");

bool is_watched = false;  ///< somebody sits at a terminal; known before signals come

extern "C" void on_stop_signal(int signal) {
  if (!is_awaited || received != 0) ::_exit(128 + signal);
  received = signal;
  constexpr std::string_view word = "\nending when what is begun is done; a second signal ends at once\n";
  if (is_watched && ::write(STDERR_FILENO, word.data(), word.size()) < 0) return;  // then nobody hears of it
}

}  // namespace

void end_on_signals() {
  is_watched = ::isatty(STDERR_FILENO) == 1;
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
