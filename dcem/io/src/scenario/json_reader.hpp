#pragma once
/// Strict reading of JSON: every value knows its place, every error names it. Private to dcem::io.
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dcem/geometry/vector.hpp"
#include "dcem/io/src/scenario/keys/key_rules.hpp"

namespace dcem::io {

class JsonDocument;
class JsonObject;

/// A value, its place, and the forms that it may have. Lives no longer than its document.
class JsonValue {
 public:
  /// `forms` null: nothing is known of the value yet; only `object` with a block reads it.
  JsonValue(const JsonDocument& document, const nlohmann::json& value, std::string path,
            const std::vector<keys::ValueRule>* forms)
      : document_(&document), value_(&value), path_(std::move(path)), forms_(forms) {}

  const std::string& path() const { return path_; }  ///< "propagation.rays", "objects[3].id"; empty for the whole
  const nlohmann::json& raw() const { return *value_; }
  std::string place() const;  ///< FILE:LINE, or FILE where there are no lines
  /// Whether the rules allow such a form here.
  bool may_be(keys::ValueKind kind) const;

  /// Throws InputError: `FILE[:LINE]: path: what`.
  [[noreturn]] void fail(const std::string& what) const;
  /// The same where the value is not what the rules expect: says what was found.
  [[noreturn]] void fail_expected() const;
  [[noreturn]] void fail_expected(const std::string& expectation) const;

  bool is_null() const;
  bool is_object() const;
  bool is_string() const;
  bool is_number() const;
  bool is_boolean() const;

  // Each throws InputError where the value is of another type or out of the range that the rules give.
  bool boolean() const;
  std::string text() const;        ///< not empty
  std::string line() const;        ///< text on one line
  std::string identifier() const;  ///< text that may stand in a file name and in one line
  std::string word() const;        ///< one of the words of the rules
  double number() const;
  long long integer() const;
  Vec3 vector3() const;  ///< three numbers
  /// Of an array with as many elements as the rules want.
  std::vector<JsonValue> elements() const;
  /// An object all of whose keys are among those of its block.
  JsonObject object() const;
  JsonObject object(const keys::BlockRule& block) const;
  /// The value of a key of an object; the key must be there.
  JsonValue member(const std::string& key) const;
  /// The keys and values of an object whose keys the user chooses.
  std::vector<std::pair<std::string, JsonValue>> entries() const;

 private:
  std::string child_path(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
  const keys::ValueRule& rule(keys::ValueKind kind) const;
  [[noreturn]] void fail_unknown(const keys::BlockRule& block, const std::string& key) const;

  const JsonDocument* document_;
  const nlohmann::json* value_;
  std::string path_;
  const std::vector<keys::ValueRule>* forms_;
};

/// An object whose keys have been checked.
class JsonObject {
 public:
  JsonObject(JsonValue value, const keys::BlockRule& block, std::map<std::string, JsonValue> members)
      : value_(std::move(value)), block_(&block), members_(std::move(members)) {}

  const JsonValue& value() const { return value_; }
  [[noreturn]] void fail(const std::string& what) const { value_.fail(what); }
  bool has(const std::string& key) const { return find(key).has_value(); }
  /// The key must be one of the block.
  std::optional<JsonValue> find(const std::string& key) const;
  /// Throws InputError where the key is missing.
  JsonValue at(const std::string& key) const;
  /// The key that is there of those of which the block wants exactly one. Throws InputError for none or several.
  std::string chosen(const std::string& choice) const;

  // The value of a key, or a default where it is missing.
  double number(const std::string& key, double absent) const;
  long long integer(const std::string& key, long long absent) const;
  /// The same where it counts something.
  std::size_t count(const std::string& key, std::size_t absent) const;
  bool boolean(const std::string& key, bool absent) const;

 private:
  JsonValue value_;
  const keys::BlockRule* block_;
  std::map<std::string, JsonValue> members_;
};

/// A parsed document with the line of every key.
class JsonDocument {
 public:
  /// Reads a file, with comments. Throws InputError with the line: damaged JSON, a repeated key, numbers beyond what a
  /// double holds, nesting deeper than any scenario.
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
