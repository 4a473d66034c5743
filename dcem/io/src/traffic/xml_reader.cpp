#include "dcem/io/src/traffic/xml_reader.hpp"

#include <expat.h>
#include <zlib.h>

#include <new>
#include <system_error>

#include "dcem/core/error.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/read_log.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

/// Far beyond every file of SUMO; they bound the memory whatever stands in a file.
constexpr std::size_t deepest_element = 100;
constexpr long long longest_token_bytes = 4'000'000;

void check_readable(const std::filesystem::path& file, const std::string& expectation) {
  if (const auto trouble = trouble_of(file)) throw InputError(file.string(), *trouble + "; " + expectation);
  ReadLog::note(file);
}

}  // namespace

std::optional<std::string_view> XmlAttributes::find(std::string_view name) const {
  for (const char** entry = names_and_values_; *entry != nullptr; entry += 2) {
    if (name == entry[0]) return std::string_view(entry[1]);
  }
  return std::nullopt;
}

/// The two C libraries: zlib, which passes plain files through, and expat.
struct XmlReader::Parser {
  explicit Parser(XmlReader& reader, const std::string& file)
      : stream(gzopen(file.c_str(), "rb")), expat(XML_ParserCreate(nullptr)) {
    if (expat == nullptr) throw std::bad_alloc();
    XML_SetUserData(expat, &reader);
    XML_SetElementHandler(expat, &on_start, &on_end);
    XML_SetStartDoctypeDeclHandler(expat, &on_doctype);
  }
  ~Parser() {
    XML_ParserFree(expat);
    if (stream != nullptr) gzclose(stream);
  }
  Parser(const Parser&) = delete;
  Parser& operator=(const Parser&) = delete;

  /// Runs a handler and keeps what it throws.
  template <typename Action>
  static void guarded(void* user_data, const Action& action) {
    XmlReader& reader = *static_cast<XmlReader*>(user_data);
    if (reader.error_) return;  // expat may go on for one more call after it was told to stop
    try {
      action(reader);
    } catch (...) {
      reader.error_ = std::current_exception();
      XML_StopParser(reader.parser_->expat, XML_FALSE);
    }
  }

  static void on_start(void* user_data, const char* name, const char** attributes) {
    guarded(user_data, [&](XmlReader& reader) {
      if (++reader.depth_ > deepest_element) reader.fail("nested too deeply; " + reader.expectation_);
      reader.handler_.start_element(name, XmlAttributes(attributes));
    });
  }
  static void on_end(void* user_data, const char* name) {
    guarded(user_data, [&](XmlReader& reader) {
      --reader.depth_;
      reader.handler_.end_element(name);
    });
  }
  static void on_doctype(void* user_data, const char*, const char*, const char*, int) {
    guarded(user_data,
            [](XmlReader& reader) { reader.fail("a document type declaration (<!DOCTYPE ...>); expected none"); });
  }

  gzFile stream;
  XML_Parser expat;
};

XmlReader::XmlReader(const std::filesystem::path& file, const std::string& expectation, XmlHandler& handler,
                     std::size_t chunk_bytes)
    : name_(file.string()), expectation_(expectation), handler_(handler), chunk_bytes_(chunk_bytes) {
  DCEM_ASSERT(chunk_bytes > 0 && chunk_bytes <= 1'000'000'000);
  check_readable(file, expectation);
  parser_ = std::make_unique<Parser>(*this, name_);
  if (parser_->stream == nullptr) throw InputError(name_, "cannot be opened; " + expectation);
}

XmlReader::~XmlReader() = default;

std::size_t XmlReader::line() const {
  return static_cast<std::size_t>(XML_GetCurrentLineNumber(parser_->expat));
}

void XmlReader::fail(const std::string& what) const {
  throw InputError(name_, line(), what);
}

void XmlReader::pause() {
  paused_ = true;
  XML_StopParser(parser_->expat, XML_TRUE);
}

bool XmlReader::read_on() {
  XML_Parser expat = parser_->expat;
  while (true) {
    XML_Status status = XML_STATUS_OK;
    if (paused_) {
      paused_ = false;
      status = XML_ResumeParser(expat);
    } else if (all_given_) {
      return false;
    } else {
      check_progress();
      const int bytes = read_chunk();
      status = XML_ParseBuffer(expat, bytes, all_given_ ? XML_TRUE : XML_FALSE);
    }
    if (error_) std::rethrow_exception(error_);
    if (status == XML_STATUS_ERROR) {
      const char* words = XML_ErrorString(XML_GetErrorCode(expat));
      fail("damaged XML: " + std::string(words != nullptr ? words : "unknown error") + "; " + expectation_);
    }
    if (status == XML_STATUS_SUSPENDED) return true;
  }
}

/// Fills the parser's buffer; returns how many bytes are new.
int XmlReader::read_chunk() {
  void* const buffer = XML_GetBuffer(parser_->expat, static_cast<int>(chunk_bytes_));
  if (buffer == nullptr) throw std::bad_alloc();
  const int bytes = gzread(parser_->stream, buffer, static_cast<unsigned>(chunk_bytes_));
  int code = Z_OK;
  const char* const words = gzerror(parser_->stream, &code);
  if (code == Z_BUF_ERROR) fail("the compressed data breaks off; expected the whole .gz file");
  if (bytes < 0 && code == Z_ERRNO) throw InputError(name_, "cannot be read; " + expectation_);
  if (bytes < 0) fail("damaged compressed data (" + printable(words) + "); expected a .gz file or plain XML");
  bytes_given_ += bytes;
  all_given_ = static_cast<std::size_t>(bytes) < chunk_bytes_;
  return bytes;
}

/// The parser keeps what it has not yet understood: a tag without end must not fill the memory.
void XmlReader::check_progress() const {
  const long long understood = XML_GetCurrentByteIndex(parser_->expat);
  if (bytes_given_ - understood > longest_token_bytes) fail("a tag or comment of more than 4 MB; " + expectation_);
}

}  // namespace dcem::io
