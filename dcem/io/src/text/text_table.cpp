#include "dcem/io/text_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace dcem::io {

std::string format_fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  // 309 digits before the point is the most that a double needs.
  std::array<char, 400> buffer{};
  const int digits = std::clamp(decimals, 0, 60);
  const auto end =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::fixed, digits).ptr;
  std::string text(buffer.data(), end);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.front() == '-' ? text.substr(1) : text;
}

std::size_t character_count(std::string_view text) {
  const auto starts_character = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; };
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), starts_character));
}

std::string memory_text(double bytes) {
  constexpr double smallest = 10.0;  // of a figure that is shown in a unit
  for (const auto& [unit_bytes, unit] : {std::pair(1e9, " GB"), std::pair(1e6, " MB"), std::pair(1e3, " kB")}) {
    if (bytes >= smallest * unit_bytes) return format_fixed(bytes / unit_bytes, 0) + unit;
  }
  return format_fixed(bytes, 0) + " bytes";
}

TextTable::TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {
  if (columns_.empty()) throw std::invalid_argument("TextTable: at least one column is needed");
}

void TextTable::add_row(std::vector<std::string> cells) {
  if (cells.size() != columns_.size()) {
    throw std::invalid_argument("TextTable: " + std::to_string(cells.size()) + " cells for " +
                                std::to_string(columns_.size()) + " columns");
  }
  rows_.push_back(std::move(cells));
}

std::string TextTable::str() const {
  const std::vector<std::size_t> widths = column_widths();
  std::vector<std::string> headings;
  std::vector<std::string> rules;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    headings.push_back(columns_[i].heading);
    rules.emplace_back(widths[i], '-');
  }
  std::string text;
  const bool has_head =
      std::any_of(headings.begin(), headings.end(), [](const auto& heading) { return !heading.empty(); });
  if (has_head) text += line(headings, widths) + line(rules, widths);
  for (const auto& row : rows_) text += line(row, widths);
  return text;
}

std::vector<std::size_t> TextTable::column_widths() const {
  std::vector<std::size_t> widths;
  for (const Column& column : columns_) widths.push_back(character_count(column.heading));
  for (const auto& row : rows_) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], character_count(row[i]));
  }
  return widths;
}

std::string TextTable::line(const std::vector<std::string>& cells, const std::vector<std::size_t>& widths) const {
  std::string text;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string padding(widths[i] - character_count(cells[i]), ' ');
    if (i > 0) text += "  ";
    text += columns_[i].align == Align::right ? padding + cells[i] : cells[i] + padding;
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text + "\n";
}

}  // namespace dcem::io
