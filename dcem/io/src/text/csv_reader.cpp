#include "dcem/io/src/text/csv_reader.hpp"

#include <algorithm>
#include <utility>

#include "dcem/io/input_error.hpp"
#include "dcem/io/known_names.hpp"

namespace dcem::io {

CsvReader::CsvReader(std::string file, std::string_view text, std::vector<Column> columns, std::string expectation,
                     OtherColumns others, EmptyLines empty_lines)
    : file_(std::move(file)),
      lines_(text),
      columns_(std::move(columns)),
      expectation_(std::move(expectation)),
      empty_lines_(empty_lines),
      field_of_(columns_.size()) {
  if (!lines_.next() || trimmed(lines_.line()).empty()) throw InputError(file_, "is empty; expected " + expectation_);
  read_header(others);
}

void CsvReader::read_header(OtherColumns others) {
  split();
  width_ = fields_.size();
  std::vector<std::string> names;
  for (const Column& column : columns_) names.push_back(column.name);
  for (std::size_t field = 0; field < width_; ++field) {
    const std::string_view name = trimmed(fields_[field]);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      if (others == OtherColumns::ignored) continue;
      fail("unknown column " + in_quotes(name) + expected_names(name, names));
    }
    std::optional<std::size_t>& place = field_of_[static_cast<std::size_t>(found - names.begin())];
    if (place) fail("column " + in_quotes(name) + " is there twice; expected it once");
    place = field;
  }
  for (std::size_t column = 0; column < columns_.size(); ++column) {
    if (field_of_[column] || !columns_[column].is_required) continue;
    fail("the column " + in_quotes(names[column]) + " is missing; expected " + expectation_ +
         (others == OtherColumns::ignored
              ? ", where the nearest one is " + in_quotes(nearest_name(names[column], fields_))
              : ""));
  }
}

bool CsvReader::next() {
  std::optional<std::size_t> empty_line;
  while (lines_.next()) {
    if (trimmed(lines_.line()).empty()) {
      if (!empty_line) empty_line = line();
      continue;
    }
    if (empty_line && empty_lines_ == EmptyLines::at_the_end) {
      throw InputError(file_, *empty_line, "an empty line; expected rows without gaps");
    }
    split();
    if (fields_.size() != width_) {
      fail(std::to_string(fields_.size()) + " fields; expected " + std::to_string(width_) + " as in the header");
    }
    return true;
  }
  return false;
}

void CsvReader::fail(const std::string& what) const {
  throw InputError(file_, line(), what);
}

std::string_view CsvReader::text(std::size_t column) const {
  return field_of_[column] ? trimmed(fields_[*field_of_[column]]) : std::string_view();
}

double CsvReader::number(std::size_t column, const NumberRange& range) const {
  if (!field_of_[column]) return 0.0;
  const std::optional<double> value = parse_number(text(column));
  if (!value || !range.holds(*value)) {
    fail(columns_[column].name + ": found " + in_quotes(text(column)) + "; expected " + range.text());
  }
  return *value;
}

void CsvReader::split() {
  fields_.assign(1, "");
  bool quoted = false;
  const std::string_view line = lines_.line();
  for (std::size_t index = 0; index < line.size(); ++index) {
    const char character = line[index];
    if (quoted && character == '"' && index + 1 < line.size() && line[index + 1] == '"') {
      fields_.back().push_back(line[++index]);
    } else if (character == '"' && (quoted || fields_.back().empty())) {
      quoted = !quoted;
    } else if (character == ',' && !quoted) {
      fields_.emplace_back();
    } else {
      fields_.back().push_back(character);
    }
  }
  if (quoted) fail("a quote is not closed; expected quotes in pairs");
}

}  // namespace dcem::io
