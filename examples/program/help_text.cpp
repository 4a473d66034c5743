#include "help_text.hpp"

#include <algorithm>
#include <sstream>

namespace dcem::program {
namespace {

constexpr std::size_t line_width = 100;

/// Lines of at most so many characters, where words are no longer.
std::string in_lines(const std::string& text, std::size_t width) {
  std::istringstream words(text);
  std::string lines;
  std::size_t used = 0;
  for (std::string word; words >> word;) {
    const bool is_first = used == 0;
    const bool fits = used + 1 + word.size() <= width;
    if (!is_first) lines += fits ? ' ' : '\n';
    used = is_first || !fits ? word.size() : used + 1 + word.size();
    lines += word;
  }
  return lines;
}

}  // namespace

std::string HelpText::make_option_desc(const CLI::Option* option) const {
  return in_lines(option->get_description(), line_width - get_column_width());
}

std::string HelpText::make_subcommand(const CLI::App* command) const {
  std::string line = "  " + command->get_display_name(true);
  line.resize(std::max(line.size() + 1, get_column_width()), ' ');
  for (const char letter : in_lines(command->get_description(), line_width - get_column_width())) {
    line += letter;
    if (letter == '\n') line.append(get_column_width(), ' ');
  }
  return line + '\n';
}

}  // namespace dcem::program
