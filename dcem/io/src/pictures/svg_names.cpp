#include "dcem/io/src/pictures/svg_names.hpp"

#include <map>

namespace dcem::io {
namespace {

using NewNames = std::map<std::string_view, std::string>;

constexpr std::string_view name_mark = " id=\"";

bool ends_name(char letter) {
  return letter == '"' || letter == ')';
}

NewNames new_names(std::string_view svg) {
  NewNames names;
  for (std::size_t at = svg.find(name_mark); at != std::string_view::npos; at = svg.find(name_mark, at + 1)) {
    const std::size_t first = at + name_mark.size();
    names.emplace(svg.substr(first, svg.find('"', first) - first), "n" + std::to_string(names.size()));
  }
  return names;
}

// The name that begins at `first`, up to what ends it; nothing where it is not one of those known.
const NewNames::value_type* name_at(const NewNames& names, std::string_view svg, std::size_t first) {
  std::size_t end = first;
  while (end < svg.size() && !ends_name(svg[end])) ++end;
  const auto found = names.find(svg.substr(first, end - first));
  return found == names.end() ? nullptr : &*found;
}

}  // namespace

std::string with_own_names(std::string_view svg) {
  const NewNames names = new_names(svg);
  std::string result;
  for (std::size_t at = 0; at < svg.size(); ++at) {
    result += svg[at];
    const bool is_reference = svg[at] == '#' && at > 0 && (svg[at - 1] == '"' || svg[at - 1] == '(');
    const bool is_name = result.ends_with(name_mark);
    if (!is_reference && !is_name) continue;
    if (const auto* const name = name_at(names, svg, at + 1)) {
      result += name->second;
      at += name->first.size();
    }
  }
  return result;
}

}  // namespace dcem::io
