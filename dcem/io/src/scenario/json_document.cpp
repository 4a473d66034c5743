#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "dcem/io/input_error.hpp"
#include "dcem/io/src/scenario/json_reader.hpp"
#include "dcem/io/src/scenario/known_formats.hpp"
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

JsonDocument::JsonDocument(const std::filesystem::path& file)
    : name_(file.string()), content_(std::make_unique<Content>()) {
  const std::string text = read_text_file(file, "expected a scenario in JSON");
  std::size_t line = 1;
  PlaceRecorder recorder(name_, line);
  try {
    constexpr bool with_exceptions = true, with_comments = true;
    content_->value =
        json::parse(LineCountingIterator(text.data(), &line), LineCountingIterator(text.data() + text.size(), &line),
                    std::ref(recorder), with_exceptions, with_comments);
  } catch (const json::exception& error) {
    refuse_known_format(file, text);
    throw InputError(name_, line, parser_words(error.what()) + "; expected well-formed JSON");
  }
  content_->lines = recorder.take_lines();
}

JsonDocument::JsonDocument(std::string name, json value)
    : name_(std::move(name)), content_(std::make_unique<Content>(Content{std::move(value), {}})) {}

JsonDocument::~JsonDocument() = default;

JsonValue JsonDocument::root() const {
  return {*this, content_->value, "", nullptr};
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

}  // namespace dcem::io
