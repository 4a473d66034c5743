#include "dcem/io/src/text/unicode.hpp"

#include <bit>
#include <cstddef>
#include <stdexcept>

namespace dcem::io {
namespace {

[[noreturn]] void throw_not_utf8() {
  throw std::invalid_argument("a text is not UTF-8");
}

// Takes one character off the front of a text.
char32_t take_character(std::string_view& text) {
  const auto lead = static_cast<unsigned char>(text.front());
  const auto leading_ones = static_cast<std::size_t>(std::countl_one(lead));
  const std::size_t length = leading_ones == 0 ? 1 : leading_ones;
  if (leading_ones == 1 || length > 4 || text.size() < length) throw_not_utf8();
  char32_t character = length == 1 ? lead : lead & (0x7fu >> length);
  for (std::size_t i = 1; i < length; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if (next >> 6 != 0x02) throw_not_utf8();
    character = (character << 6) | (next & 0x3fu);
  }
  constexpr char32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
  if (character < smallest[length] || character > 0x10ffff || (character >= 0xd800 && character < 0xe000)) {
    throw_not_utf8();
  }
  text.remove_prefix(length);
  return character;
}

}  // namespace

std::u32string decoded(std::string_view text) {
  std::u32string characters;
  while (!text.empty()) characters += take_character(text);
  return characters;
}

std::u16string utf16(std::string_view text) {
  std::u16string units;
  for (const char32_t character : decoded(text)) {
    if (character < 0x10000) {
      units += static_cast<char16_t>(character);
      continue;
    }
    units += static_cast<char16_t>(0xd800 + ((character - 0x10000) >> 10));
    units += static_cast<char16_t>(0xdc00 + ((character - 0x10000) & 0x3ff));
  }
  return units;
}

}  // namespace dcem::io
