#pragma once
/// Strict reading of JSON: every value knows its place, every error names it. Private to dcem::io.
#include <cstddef>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dcem/geometry/vector.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

class JsonDocument;
class JsonObject;

/// A value and its place. Lives no longer than its document.
class JsonValue {
 public:
  JsonValue(const JsonDocument& document, const nlohmann::json& value, std::string path)
      : document_(&document), value_(&value), path_(std::move(path)) {}

  const std::string& path() const { return path_; }  ///< "propagation.rays", "objects[3].id"; empty for the whole
  const nlohmann::json& raw() const { return *value_; }
  std::string place() const;  ///< FILE:LINE, or FILE where there are no lines

  /// Throws InputError: `FILE[:LINE]: path: what`.
  [[noreturn]] void fail(const std::string& what) const;
  /// Throws InputError: the value is legal, but this version does not offer it.
  [[noreturn]] void not_in_this_version(const std::string& expectation) const;
  /// The same where the value is not what was expected: says what was found.
  [[noreturn]] void fail_expected(const std::string& expectation) const;

  bool is_null() const;
  bool is_object() const;
  bool is_string() const;
  bool is_number() const;
  bool is_boolean() const;

  // Each throws InputError where the value is of another type or out of range.
  bool boolean() const;
  std::string text() const;        ///< not empty
  std::string line() const;        ///< text on one line
  std::string identifier() const;  ///< text that may stand in a file name and in one line
  std::string one_of(const std::vector<std::string>& choices) const;
  double number(const NumberRange& range) const;
  long long integer(long long minimum, long long maximum) const;
  Vec3 vector3(double limit) const;  ///< three numbers within ±limit
  std::vector<JsonValue> elements() const;
  /// The elements of an array of a given length.
  std::vector<JsonValue> elements(std::size_t count, const std::string& expectation) const;
  /// An object all of whose keys are among the known ones.
  JsonObject object(const std::vector<std::string>& known_keys) const;
  /// The value of a key of an object; the key must be there.
  JsonValue member(const std::string& key) const;
  /// The keys and values of an object whose keys the user chooses.
  std::vector<std::pair<std::string, JsonValue>> entries() const;

 private:
  std::string child_path(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

  const JsonDocument* document_;
  const nlohmann::json* value_;
  std::string path_;
};

/// An object whose keys have been checked.
class JsonObject {
 public:
  JsonObject(JsonValue value, std::map<std::string, JsonValue> members)
      : value_(std::move(value)), members_(std::move(members)) {}

  const JsonValue& value() const { return value_; }
  [[noreturn]] void fail(const std::string& what) const { value_.fail(what); }
  bool has(const std::string& key) const { return members_.contains(key); }
  std::optional<JsonValue> find(const std::string& key) const;
  /// Throws InputError where the key is missing.
  JsonValue at(const std::string& key) const;
  /// Throws InputError unless exactly one of the keys is there; returns it.
  std::string exactly_one_of(const std::vector<std::string>& keys) const;

  // The value of a key, or a default where it is missing.
  double number(const std::string& key, double absent, const NumberRange& range) const;
  long long integer(const std::string& key, long long absent, long long minimum, long long maximum) const;
  bool boolean(const std::string& key, bool absent) const;

 private:
  JsonValue value_;
  std::map<std::string, JsonValue> members_;
};

/// A parsed document with the line of every key.
class JsonDocument {
 public:
  /// Reads a file. Throws InputError with the line: damaged JSON, a repeated key, numbers beyond what a double holds,
  /// nesting deeper than any scenario.
  explicit JsonDocument(const std::filesystem::path& file);
  /// Values that come from elsewhere; `name` stands where a file name would.
  JsonDocument(std::string name, nlohmann::json value);
  ~JsonDocument();
  JsonDocument(const JsonDocument&) = delete;
  JsonDocument& operator=(const JsonDocument&) = delete;

  const std::string& name() const { return name_; }
  JsonValue root() const;
  /// Line of a key, or of the nearest key around it; 0 where there are no lines.
  std::size_t line_of(std::string path) const;

 private:
  std::string name_;
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace dcem::io
