#include "dcem/io/src/pictures/canvas.hpp"

#include <array>

namespace dcem::io {
namespace {

// Bytes of the character that begins here, by its first byte (RFC 3629); 0 where none does.
std::size_t character_bytes(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first <= 0xdf) return 2;
  if (first >= 0xe0 && first <= 0xef) return 3;
  return first >= 0xf0 && first <= 0xf4 ? 4 : 0;
}

// The character that begins at a byte, or nothing: cut, overlong, half of a pair, or beyond Unicode.
std::string_view character_at(std::string_view text, std::size_t begin) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[begin + at]); };
  const std::size_t size = character_bytes(byte(0));
  if (size == 0 || begin + size > text.size()) return {};
  for (std::size_t at = 1; at < size; ++at) {
    if ((byte(at) & 0xc0U) != 0x80U) return {};
  }
  const bool overlong = (byte(0) == 0xe0 && byte(1) < 0xa0) || (byte(0) == 0xf0 && byte(1) < 0x90);
  const bool beyond = (byte(0) == 0xed && byte(1) > 0x9f) || (byte(0) == 0xf4 && byte(1) > 0x8f);
  return overlong || beyond ? std::string_view() : text.substr(begin, size);
}

}  // namespace

std::string drawable_text(std::string_view text) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view character = character_at(text, at);
    const auto first = static_cast<unsigned char>(text[at]);
    const bool is_control = first < 0x20 || first == 0x7f;
    if (character.empty() || is_control) {
      result += is_control ? ' ' : '?';
      ++at;
    } else {
      result += character;
      at += character.size();
    }
  }
  return result;
}

void require_drawing(const AtomicFile& file) {
  if (!can_draw()) throw OutputError(file.target(), std::string(no_drawing), std::string(drawing_expected));
}

void draw_frame(Canvas& canvas, const PixelRect& area, const Stroke& stroke, double outside_px) {
  const double left = area.x - outside_px, top = area.y - outside_px, right = area.right() + outside_px,
               bottom = area.bottom() + outside_px;
  const std::array<PixelPoint, 4> corners{{{left, top}, {right, top}, {right, bottom}, {left, bottom}}};
  canvas.draw_line(corners, stroke, true);
}

}  // namespace dcem::io
