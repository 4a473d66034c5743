#pragma once
/// Errors in the files a user hands over.
#include <stdexcept>
#include <string>

namespace dcem::io {

/// `FILE[:LINE]: what is wrong; what was expected`, on one line.
class InputError : public std::runtime_error {
 public:
  InputError(const std::string& file, const std::string& what) : std::runtime_error(file + ": " + what) {}
  InputError(const std::string& file, std::size_t line, const std::string& what)
      : std::runtime_error(file + ":" + std::to_string(line) + ": " + what) {}
};

}  // namespace dcem::io
