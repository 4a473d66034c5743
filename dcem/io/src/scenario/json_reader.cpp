#include "dcem/io/src/scenario/json_reader.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "dcem/core/error.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

using nlohmann::json;

/// Deeper than any scenario; keeps paths short whatever the input.
constexpr std::size_t deepest_nesting = 30;

/// Walks through a text and counts the lines passed.
class LineCountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  LineCountingIterator(const char* position, std::size_t* line) : position_(position), line_(line) {}

  reference operator*() const { return *position_; }
  LineCountingIterator& operator++() {
    if (*position_++ == '\n') ++*line_;
    return *this;
  }
  LineCountingIterator operator++(int) {
    const LineCountingIterator before = *this;
    ++*this;
    return before;
  }
  friend bool operator==(const LineCountingIterator& a, const LineCountingIterator& b) {
    return a.position_ == b.position_;
  }

 private:
  const char* position_;
  std::size_t* line_;
};

/// Follows the parser and notes the line of every key and of every object in an array.
class PlaceRecorder {
 public:
  PlaceRecorder(const std::string& file, const std::size_t& line) : file_(file), line_(line) {}

  bool operator()(int, json::parse_event_t event, const json& parsed) {
    switch (event) {
      case json::parse_event_t::object_start:
      case json::parse_event_t::array_start:
        begin_value();
        if (levels_.size() >= deepest_nesting) throw InputError(file_, line_, "nested too deeply; expected a scenario");
        levels_.push_back({event == json::parse_event_t::array_start, 0, {}, {}, current_path()});
        // Not for arrays in arrays: a list of a million points would be noted point by point.
        if (event == json::parse_event_t::object_start) lines_.try_emplace(levels_.back().path, line_);
        break;
      case json::parse_event_t::key:
        enter_key(parsed.get_ref<const std::string&>());
        break;
      case json::parse_event_t::value:
        begin_value();
        break;
      case json::parse_event_t::object_end:
      case json::parse_event_t::array_end:
        levels_.pop_back();
        break;
    }
    return true;
  }

  std::map<std::string, std::size_t> take_lines() { return std::move(lines_); }

 private:
  struct Level {
    bool is_array;
    std::size_t values;  // begun so far
    std::string key;     // the last one
    std::set<std::string> keys;
    std::string path;
  };

  void begin_value() {
    if (!levels_.empty()) ++levels_.back().values;
  }

  std::string current_path() const {
    if (levels_.empty()) return {};
    const Level& level = levels_.back();
    if (level.is_array) return level.path + "[" + std::to_string(level.values - 1) + "]";
    return level.path.empty() ? level.key : level.path + "." + level.key;
  }

  void enter_key(const std::string& key) {
    Level& level = levels_.back();
    level.key = key;
    if (!level.keys.insert(key).second) {
      const std::string where = level.path.empty() ? "" : printable(level.path) + ": ";
      throw InputError(file_, line_, where + "key " + in_quotes(key) + " stands twice; expected it once");
    }
    lines_[current_path()] = line_;
  }

  const std::string& file_;
  const std::size_t& line_;
  std::vector<Level> levels_;
  std::map<std::string, std::size_t> lines_;
};

/// The parser's words without its own name and number: "syntax error while parsing value - unexpected end of input".
std::string parser_words(const std::string& message) {
  const std::size_t bracket = message.find("] ");
  std::string words = bracket == std::string::npos ? message : message.substr(bracket + 2);
  const std::size_t position = words.find("column ");
  if (position != std::string::npos) {
    const std::size_t colon = words.find(": ", position);
    if (colon != std::string::npos) words.erase(0, colon + 2);
  }
  return printable(words.substr(0, words.find("; ")));  // behind it: what the parser would have liked
}

}  // namespace

struct JsonDocument::Content {
  json value;
  std::map<std::string, std::size_t> lines;
};

// ---------------------------------------------------------------------------------------------------------------------

JsonDocument::JsonDocument(const std::filesystem::path& file)
    : name_(file.string()), content_(std::make_unique<Content>()) {
  const std::string text = read_text_file(file, "expected a scenario in JSON");
  std::size_t line = 1;
  PlaceRecorder recorder(name_, line);
  try {
    content_->value = json::parse(LineCountingIterator(text.data(), &line),
                                  LineCountingIterator(text.data() + text.size(), &line), std::ref(recorder));
  } catch (const json::exception& error) {
    throw InputError(name_, line, parser_words(error.what()) + "; expected well-formed JSON");
  }
  content_->lines = recorder.take_lines();
}

JsonDocument::JsonDocument(std::string name, json value)
    : name_(std::move(name)), content_(std::make_unique<Content>(Content{std::move(value), {}})) {}

JsonDocument::~JsonDocument() = default;

JsonValue JsonDocument::root() const {
  return {*this, content_->value, ""};
}

std::size_t JsonDocument::line_of(std::string path) const {
  while (true) {
    const auto found = content_->lines.find(path);
    if (found != content_->lines.end()) return found->second;
    if (path.empty()) return 0;
    const std::size_t cut = path.find_last_of(".[");
    path.resize(cut == std::string::npos ? 0 : cut);
  }
}

// ---------------------------------------------------------------------------------------------------------------------

void JsonValue::fail(const std::string& what) const {
  throw InputError(place(), (path_.empty() ? "" : printable(path_) + ": ") + what);
}

std::string JsonValue::place() const {
  const std::size_t line = document_->line_of(path_);
  return line == 0 ? document_->name() : document_->name() + ":" + std::to_string(line);
}

void JsonValue::fail_expected(const std::string& expectation) const {
  const json::error_handler_t repair = json::error_handler_t::replace;
  fail((value_->is_structured() ? std::string("found an ") + value_->type_name()
                                : "found " + in_quotes(value_->dump(-1, ' ', false, repair))) +
       "; expected " + expectation);
}

void JsonValue::not_in_this_version(const std::string& expectation) const {
  fail("not in this version; expected " + expectation);
}

bool JsonValue::is_null() const {
  return value_->is_null();
}
bool JsonValue::is_object() const {
  return value_->is_object();
}
bool JsonValue::is_string() const {
  return value_->is_string();
}
bool JsonValue::is_number() const {
  return value_->is_number();
}
bool JsonValue::is_boolean() const {
  return value_->is_boolean();
}

bool JsonValue::boolean() const {
  if (!value_->is_boolean()) fail_expected("true or false");
  return value_->get<bool>();
}

std::string JsonValue::text() const {
  if (!value_->is_string() || value_->get_ref<const std::string&>().empty()) fail_expected("text that is not empty");
  return value_->get<std::string>();
}

std::string JsonValue::line() const {
  if (!value_->is_string() || !is_printable(text())) fail_expected("text without control characters");
  return text();
}

std::string JsonValue::identifier() const {
  constexpr std::size_t longest = 200;
  const std::string name = text();
  const bool plain = is_printable(name) && name.find_first_of("/\\") == std::string::npos;
  if (!plain || name.size() > longest)
    fail_expected("a name without slashes and control characters, at most 200 bytes");
  return name;
}

std::string JsonValue::one_of(const std::vector<std::string>& choices) const {
  if (value_->is_string()) {
    const auto found = std::find(choices.begin(), choices.end(), value_->get_ref<const std::string&>());
    if (found != choices.end()) return *found;
  }
  std::string expectation;
  for (std::size_t index = 0; index < choices.size(); ++index) {
    expectation += (index == 0 ? "" : index + 1 < choices.size() ? ", " : " or ") + choices[index];
  }
  fail_expected(expectation);
}

double JsonValue::number(const NumberRange& range) const {
  if (!value_->is_number()) fail_expected(range.text());
  const double value = value_->get<double>();
  if (!std::isfinite(value) || !range.holds(value)) fail_expected(range.text());
  return value;
}

long long JsonValue::integer(long long minimum, long long maximum) const {
  const std::string expectation = "a whole number from " + std::to_string(minimum) + " to " + std::to_string(maximum);
  if (value_->is_number_unsigned() && value_->get<unsigned long long>() > static_cast<unsigned long long>(maximum)) {
    fail_expected(expectation);
  }
  if (value_->is_number_float()) {
    // 2e3 is a whole number too; beyond 2^53 a double cannot tell one from the next.
    const double real = value_->get<double>();
    if (!(std::abs(real) <= 9007199254740992.0) || real != std::floor(real)) fail_expected(expectation);
  } else if (!value_->is_number()) {
    fail_expected(expectation);
  }
  const auto value = value_->get<long long>();
  if (value < minimum || value > maximum) fail_expected(expectation);
  return value;
}

Vec3 JsonValue::vector3(double limit) const {
  const std::vector<JsonValue> numbers = elements(3, "three numbers [x, y, z]");
  Vec3 vector(0.0);
  for (int axis = 0; axis < 3; ++axis) {
    vector[axis] = numbers[static_cast<std::size_t>(axis)].number({-limit, limit});
  }
  return vector;
}

std::vector<JsonValue> JsonValue::elements() const {
  if (!value_->is_array()) fail_expected("an array [...]");
  std::vector<JsonValue> result;
  result.reserve(value_->size());
  for (const json& element : *value_) {
    result.emplace_back(*document_, element, path_ + "[" + std::to_string(result.size()) + "]");
  }
  return result;
}

std::vector<JsonValue> JsonValue::elements(std::size_t count, const std::string& expectation) const {
  if (!value_->is_array() || value_->size() != count) fail_expected(expectation);
  return elements();
}

JsonObject JsonValue::object(const std::vector<std::string>& known_keys) const {
  std::map<std::string, JsonValue> members;
  for (auto& [key, value] : entries()) {
    if (std::find(known_keys.begin(), known_keys.end(), key) == known_keys.end()) {
      value.fail("unknown key; the nearest known one is '" + nearest_name(key, known_keys) + "'");
    }
    members.emplace(key, std::move(value));
  }
  return {*this, std::move(members)};
}

JsonValue JsonValue::member(const std::string& key) const {
  DCEM_ASSERT(value_->is_object() && value_->contains(key));
  return {*document_, (*value_)[key], child_path(key)};
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::entries() const {
  if (!value_->is_object()) fail_expected("an object {...}");
  std::vector<std::pair<std::string, JsonValue>> result;
  for (const auto& [key, value] : value_->items())
    result.emplace_back(key, JsonValue(*document_, value, child_path(key)));
  return result;
}

// ---------------------------------------------------------------------------------------------------------------------

std::optional<JsonValue> JsonObject::find(const std::string& key) const {
  const auto member = members_.find(key);
  return member == members_.end() ? std::nullopt : std::optional(member->second);
}

JsonValue JsonObject::at(const std::string& key) const {
  const std::optional<JsonValue> value = find(key);
  if (!value) fail("the key '" + key + "' is missing; expected it here");
  return *value;
}

std::string JsonObject::exactly_one_of(const std::vector<std::string>& keys) const {
  std::string list, found;
  std::size_t count = 0;
  for (const std::string& key : keys) {
    list += (list.empty() ? "" : ", ") + key;
    if (has(key)) found = (count++ == 0 ? "" : found + ", ") + key;
  }
  if (count != 1) fail("found " + (count == 0 ? "none" : found) + "; expected exactly one of " + list);
  return found;
}

double JsonObject::number(const std::string& key, double absent, const NumberRange& range) const {
  const std::optional<JsonValue> value = find(key);
  return value ? value->number(range) : absent;
}

long long JsonObject::integer(const std::string& key, long long absent, long long minimum, long long maximum) const {
  const std::optional<JsonValue> value = find(key);
  return value ? value->integer(minimum, maximum) : absent;
}

bool JsonObject::boolean(const std::string& key, bool absent) const {
  const std::optional<JsonValue> value = find(key);
  return value ? value->boolean() : absent;
}

}  // namespace dcem::io
