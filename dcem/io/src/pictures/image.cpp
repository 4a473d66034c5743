#include "dcem/io/image.hpp"

#include <stb/stb_easy_font.h>
#include <stb/stb_image_write.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ostream>
#include <stdexcept>
#include <string>

#include "dcem/core/error.hpp"
#include "dcem/io/atomic_file.hpp"

namespace dcem::io {
namespace {

constexpr int max_side_px = 32768;

// Along longer lines the rounding of a position would be seen.
constexpr double max_coordinate_px = 1e12;

// Font dots of one line: from the top of the capitals (dot row 0) to the end of the descenders.
constexpr int font_height_dots = 9;

// Bytes that stb_easy_font writes for one rectangle: four corners of three floats and a colour.
constexpr std::size_t bytes_per_corner = 16;
constexpr std::size_t bytes_per_quad = 4 * bytes_per_corner;

// The font knows the characters 32…126 and reads beside its table for others. A character of several bytes (UTF-8)
// becomes one question mark.
std::string printable_ascii(std::string_view text) {
  std::string result;
  for (const char character : text) {
    const auto byte = static_cast<unsigned char>(character);
    if ((byte & 0xC0U) == 0x80U) continue;
    result.push_back(byte >= 32 && byte <= 126 ? character : '?');
  }
  return result;
}

// The rectangles, in font dots, that make up a text.
std::vector<PixelRect> text_rectangles(std::string_view text) {
  std::string characters = printable_ascii(text);
  // No character has more than 16 strokes.
  std::vector<char> corners((characters.size() + 1) * 16 * bytes_per_quad);
  const int quads =
      stb_easy_font_print(0.0F, 0.0F, characters.data(), nullptr, corners.data(), static_cast<int>(corners.size()));
  std::vector<PixelRect> rectangles;
  for (std::size_t quad = 0; quad < static_cast<std::size_t>(quads); ++quad) {
    std::array<float, 2> low{};
    std::array<float, 2> high{};
    // The corners run around the rectangle: the third is opposite to the first.
    std::memcpy(low.data(), &corners[quad * bytes_per_quad], sizeof(low));
    std::memcpy(high.data(), &corners[quad * bytes_per_quad + 2 * bytes_per_corner], sizeof(high));
    rectangles.push_back({static_cast<int>(low[0]), static_cast<int>(low[1]), static_cast<int>(high[0] - low[0]),
                          static_cast<int>(high[1] - low[1])});
  }
  // The font's 'w' reads like a 'u'; one more dot of its middle stroke tells them apart.
  for (std::size_t i = characters.find('w'); i != std::string::npos; i = characters.find('w', i + 1)) {
    std::string before = characters.substr(0, i);
    rectangles.push_back({stb_easy_font_width(before.data()) + 2, 4, 1, 1});
  }
  return rectangles;
}

double distance_to_segment(PixelPoint point, PixelPoint from, PixelPoint to) {
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double length_squared = dx * dx + dy * dy;
  const double along = (point.x - from.x) * dx + (point.y - from.y) * dy;
  const double share = length_squared > 0.0 ? std::clamp(along / length_squared, 0.0, 1.0) : 0.0;
  return std::hypot(point.x - from.x - share * dx, point.y - from.y - share * dy);
}

// Pixels `first` … `last` that a stretch of continuous coordinates touches, within [begin, end).
struct PixelSpan {
  int first;
  int last;
};
PixelSpan touched_pixels(double low, double high, int begin, int end) {
  const double bounded_low = std::clamp(std::floor(low), static_cast<double>(begin), static_cast<double>(end));
  const double bounded_high =
      std::clamp(std::floor(high), static_cast<double>(begin) - 1.0, static_cast<double>(end) - 1.0);
  return {static_cast<int>(bounded_low), static_cast<int>(bounded_high)};
}

}  // namespace

Colour mix(Colour from, Colour to, double share) {
  const auto channel = [share](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(a + std::clamp(share, 0.0, 1.0) * (b - a)));
  };
  return {channel(from.red, to.red), channel(from.green, to.green), channel(from.blue, to.blue)};
}

PixelRect intersection(const PixelRect& first, const PixelRect& second) {
  const int x = std::max(first.x, second.x);
  const int y = std::max(first.y, second.y);
  return {x, y, std::max(0, std::min(first.right(), second.right()) - x),
          std::max(0, std::min(first.bottom(), second.bottom()) - y)};
}

Image::Image(int width, int height, Colour background) : width_(width), height_(height), clip_{0, 0, width, height} {
  if (width < 1 || height < 1 || width > max_side_px || height > max_side_px) {
    throw std::invalid_argument("Image: " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels; expected 1 to " + std::to_string(max_side_px) + " on each side");
  }
  pixels_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), background);
}

Colour Image::pixel(int x, int y) const {
  DCEM_ASSERT(bounds().contains(x, y));
  return pixels_[index(x, y)];
}

void Image::set_pixel(int x, int y, Colour colour) {
  if (clip_.contains(x, y)) pixels_[index(x, y)] = colour;
}

void Image::blend_pixel(int x, int y, Colour colour, double opacity) {
  if (clip_.contains(x, y)) pixels_[index(x, y)] = mix(pixels_[index(x, y)], colour, opacity);
}

void Image::fill_rectangle(const PixelRect& area, Colour colour) {
  const PixelRect part = intersection(area, clip_);
  for (int y = part.y; y < part.bottom(); ++y) {
    std::fill_n(pixels_.begin() + static_cast<std::ptrdiff_t>(index(part.x, y)), part.width, colour);
  }
}

void Image::shade_rectangle(const PixelRect& area, Colour colour, double opacity) {
  const PixelRect part = intersection(area, clip_);
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int x = part.x; x < part.right(); ++x) blend_pixel(x, y, colour, opacity);
  }
}

void Image::draw_frame(const PixelRect& area, Colour colour) {
  fill_rectangle({area.x, area.y, area.width, 1}, colour);
  fill_rectangle({area.x, area.bottom() - 1, area.width, 1}, colour);
  fill_rectangle({area.x, area.y, 1, area.height}, colour);
  fill_rectangle({area.right() - 1, area.y, 1, area.height}, colour);
}

void Image::hatch_rectangle(const PixelRect& area, const Hatch& hatch) {
  DCEM_ASSERT(hatch.pitch_px > 0);
  const PixelRect part = intersection(area, clip_);
  for (int y = part.y; y < part.bottom(); ++y) {
    for (int x = part.x; x < part.right(); ++x) {
      if ((x + y) % hatch.pitch_px < hatch.thickness_px) set_pixel(x, y, hatch.line);
    }
  }
}

void Image::draw_line(PixelPoint from, PixelPoint to, Colour colour, double thickness_px, double opacity) {
  const double largest = std::max({std::abs(from.x), std::abs(from.y), std::abs(to.x), std::abs(to.y)});
  if (std::isnan(from.x + from.y + to.x + to.y) || largest > max_coordinate_px) return;
  const bool steep = std::abs(to.y - from.y) > std::abs(to.x - from.x);
  // Walk along the longer direction ("along") and, at each step, across the few pixels that the line is wide there.
  const auto turned = [steep](PixelPoint point) { return steep ? PixelPoint{point.y, point.x} : point; };
  const PixelPoint start = turned(from);
  const PixelPoint end = turned(to);
  const double slope = end.x == start.x ? 0.0 : (end.y - start.y) / (end.x - start.x);
  const double reach = 0.5 * thickness_px + 1.0;
  const double reach_across = reach * std::hypot(1.0, slope) + std::abs(slope);
  const PixelRect area = steep ? PixelRect{clip_.y, clip_.x, clip_.height, clip_.width} : clip_;
  const PixelSpan along =
      touched_pixels(std::min(start.x, end.x) - reach, std::max(start.x, end.x) + reach, area.x, area.right());
  for (int a = along.first; a <= along.last; ++a) {
    const double nearest = std::clamp(a + 0.5, std::min(start.x, end.x), std::max(start.x, end.x));
    const double middle = start.y + slope * (nearest - start.x);
    const PixelSpan across = touched_pixels(middle - reach_across, middle + reach_across, area.y, area.bottom());
    for (int c = across.first; c <= across.last; ++c) {
      const double distance = distance_to_segment({a + 0.5, c + 0.5}, start, end);
      const double cover = std::clamp(0.5 * thickness_px + 0.5 - distance, 0.0, 1.0);
      if (cover > 0.0) blend_pixel(steep ? c : a, steep ? a : c, colour, cover * opacity);
    }
  }
}

void Image::draw_polygon(std::span<const PixelPoint> corners, Colour colour, double thickness_px) {
  for (std::size_t i = 0; i < corners.size(); ++i) {
    draw_line(corners[i], corners[(i + 1) % corners.size()], colour, thickness_px);
  }
}

void Image::fill_disc(PixelPoint centre, double radius_px, Colour colour) {
  draw_line(centre, centre, colour, 2.0 * radius_px);
}

void Image::draw_text(int x, int y, std::string_view text, Colour colour, int scale, TextDirection direction) {
  const int length = text_length_px(text, scale);
  for (const PixelRect& dots : text_rectangles(text)) {
    const PixelRect flat{dots.x * scale, dots.y * scale, dots.width * scale, dots.height * scale};
    if (direction == TextDirection::rightwards) {
      fill_rectangle({x + flat.x, y + flat.y, flat.width, flat.height}, colour);
    } else {
      fill_rectangle({x + flat.y, y + length - flat.right(), flat.height, flat.width}, colour);
    }
  }
}

void Image::write_png(const std::filesystem::path& path) const {
  AtomicFile file(path);
  write_png(file.stream());
  file.commit();
}

void Image::write_png(std::ostream& stream) const {
  static_assert(sizeof(Colour) == 3, "the pixels are handed to the PNG writer as they lie in memory");
  const auto write = [](void* context, void* bytes, int size) {
    static_cast<std::ostream*>(context)->write(static_cast<const char*>(bytes), size);
  };
  const int row_bytes = 3 * width_;
  if (stbi_write_png_to_func(write, &stream, width_, height_, 3, pixels_.data(), row_bytes) == 0) {
    stream.setstate(std::ios::badbit);
  }
}

int text_length_px(std::string_view text, int scale) {
  std::string characters = printable_ascii(text);
  // Every character ends with a gap of one dot; the last one's is not ink.
  return characters.empty() ? 0 : (stb_easy_font_width(characters.data()) - 1) * scale;
}

int text_height_px(int scale) {
  return font_height_dots * scale;
}

}  // namespace dcem::io
