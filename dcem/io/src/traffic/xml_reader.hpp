#pragma once
/// Streaming reading of XML, plain or compressed (.gz): the memory needed does not grow with the file. Private to
/// dcem::io.
#include <cstddef>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace dcem::io {

/// The attributes of an element, valid while its handler runs.
class XmlAttributes {
 public:
  /// Names and values in turn, ended by a null pointer.
  explicit XmlAttributes(const char** names_and_values) : names_and_values_(names_and_values) {}

  std::optional<std::string_view> find(std::string_view name) const;

 private:
  const char** names_and_values_;
};

/// What is told of each element. Exceptions end the reading and arrive where `read_on` was called.
class XmlHandler {
 public:
  virtual void start_element(std::string_view name, const XmlAttributes& attributes) = 0;
  virtual void end_element(std::string_view name) = 0;

 protected:
  ~XmlHandler() = default;
};

inline constexpr std::size_t xml_chunk_bytes = 65536;

/// Reads a file from its start to its end, chunk by chunk. Document type declarations are refused, and with them
/// entities of the file's own. All functions throw InputError with the line.
class XmlReader {
 public:
  /// Opens the file; `expectation` says what should have been there, e.g. "expected a trace". `handler` must outlive
  /// the reader.
  XmlReader(const std::filesystem::path& file, const std::string& expectation, XmlHandler& handler,
            std::size_t chunk_bytes = xml_chunk_bytes);
  ~XmlReader();
  XmlReader(const XmlReader&) = delete;
  XmlReader& operator=(const XmlReader&) = delete;

  /// Reads until the handler pauses (true) or the file ends (false).
  bool read_on();
  /// From within `end_element`: `read_on` returns, and goes on behind this element when called again.
  void pause();
  /// The line that is being read, counted from 1.
  std::size_t line() const;
  /// Throws InputError: `FILE:LINE: what`.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct Parser;

  int read_chunk();
  void check_progress() const;

  std::string name_, expectation_;
  XmlHandler& handler_;
  std::size_t chunk_bytes_;
  std::size_t depth_ = 0;
  long long bytes_given_ = 0;
  bool all_given_ = false;
  bool paused_ = false;
  std::exception_ptr error_;  ///< what the handler threw: it must not fly through the parser, which is written in C
  std::unique_ptr<Parser> parser_;
};

}  // namespace dcem::io
