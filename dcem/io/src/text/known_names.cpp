#include "dcem/io/known_names.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "dcem/core/error.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

/// What is compared of a name: bounds the work for absurd ones.
std::string_view start_of(std::string_view name) {
  constexpr std::size_t most_letters = 320;
  return name.substr(0, most_letters);
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  DCEM_ASSERT(!candidates.empty());
  const std::string_view start = start_of(name);
  return *std::min_element(candidates.begin(), candidates.end(), [&](const std::string& a, const std::string& b) {
    return edit_distance(start, a) < edit_distance(start, b);
  });
}

std::string name_hint(std::string_view name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(name, candidates);
  const std::size_t longer = std::max(name.size(), nearest.size());
  const bool is_near = 2 * edit_distance(start_of(name), nearest) <= longer + 1;
  return is_near ? " (did you mean " + in_quotes(nearest) + "?)" : "";
}

std::string expected_names(std::string_view name, const std::vector<std::string>& candidates, std::size_t most) {
  std::string text = name_hint(name, candidates);
  text += candidates.size() == 1 ? "; expected " : "; expected one of ";
  const std::size_t named = std::min(most, candidates.size());
  for (std::size_t number = 0; number < named; ++number) text += (number == 0 ? "" : ", ") + candidates[number];
  return named == candidates.size() ? text : text + ", ... (" + std::to_string(candidates.size()) + " in all)";
}

}  // namespace dcem::io
