#pragma once
/// Small traces for the tests of traffic, plain and compressed.
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "dcem/io/input_error.hpp"

namespace dcem::test {

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline void write_gz(const std::filesystem::path& path, const std::string& text) {
  const gzFile file = gzopen(path.c_str(), "wb");
  if (file == nullptr) throw std::runtime_error("cannot write " + path.string());
  const int written = gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
  if (gzclose(file) != Z_OK || written != static_cast<int>(text.size())) throw std::runtime_error("gz not written");
}

/// A trace of these lines: the first stands on line 2.
inline std::string trace(const std::string& lines) {
  return "<fcd-export>\n" + lines + "</fcd-export>\n";
}

/// A time step of these vehicles.
inline std::string step(const std::string& time_s, const std::string& vehicles) {
  return "<timestep time=\"" + time_s + "\">\n" + vehicles + "</timestep>\n";
}

inline std::string vehicle(const std::string& id, const std::string& more, const std::string& type = "car") {
  return "<vehicle id=\"" + id + "\" type=\"" + type + "\" " + more + "/>\n";
}

/// The message of the InputError that an action throws; otherwise "no error".
template <typename Action>
std::string input_error_of(const Action& action) {
  try {
    action();
  } catch (const io::InputError& error) {
    return error.what();
  }
  return "no error";
}

inline bool holds(const std::string& text, const std::string& piece) {
  return text.find(piece) != std::string::npos;
}

}  // namespace dcem::test
