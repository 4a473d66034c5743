#pragma once
/// What Ctrl-C (SIGINT) and SIGTERM do.
#include <stdexcept>
#include <string>

namespace dcem::program {

/// The run was ended by a signal; says what is written. Exit code 128 + number.
class Interrupted : public std::runtime_error {
 public:
  Interrupted(int signal, const std::string& what) : std::runtime_error(what), signal_(signal) {}
  int exit_code() const { return 128 + signal_; }

 private:
  int signal_;
};

/// From now on either signal ends the program at once, with exit code 128 + number, and removes what is half written;
/// unless it was ignored from the start, as for programs in the background of a script.
void end_on_signals();

/// While an object lives, the first signal is a request that the work looks for; the second ends the program at once.
class StopRequest {
 public:
  StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;
  ~StopRequest();

  /// The signal that came; 0: none. May be asked by any thread.
  int signal() const;
};

/// "SIGINT" or "SIGTERM".
std::string signal_name(int signal);

}  // namespace dcem::program
