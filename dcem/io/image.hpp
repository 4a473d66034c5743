#pragma once
/// Colours, places on a picture, and plain rasters: 8-bit sRGB pixels, written as PNG.
///
/// Pixel (0, 0) is the upper left one; x grows to the right, y downwards. Continuous coordinates: pixel (x, y) covers
/// the square from (x, y) to (x + 1, y + 1).
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <vector>

namespace dcem::io {

/// An sRGB colour, 0…255 per channel.
struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
  friend bool operator==(const Colour&, const Colour&) = default;
};

/// `share` = 0 gives `from`, 1 gives `to`; mixed channel by channel and rounded.
Colour mix(Colour from, Colour to, double share);

/// A rectangle of whole pixels: columns x … x + width − 1, rows y … y + height − 1.
struct PixelRect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  [[nodiscard]] int right() const { return x + width; }
  [[nodiscard]] int bottom() const { return y + height; }
  [[nodiscard]] bool contains(int column, int row) const {
    return column >= x && column < right() && row >= y && row < bottom();
  }
  friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

/// The part that two rectangles share; width and height are 0 where there is none.
PixelRect intersection(const PixelRect& first, const PixelRect& second);

/// A point in continuous pixel coordinates.
struct PixelPoint {
  double x = 0.0;
  double y = 0.0;
};

/// A raster of pixels, for what is made of cells and needs no drawing.
class Image {
 public:
  /// Throws `std::invalid_argument` unless both sides are 1…32,768 pixels.
  Image(int width, int height, Colour background = {255, 255, 255});

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] PixelRect bounds() const { return {0, 0, width_, height_}; }
  /// Requires a pixel inside the picture.
  [[nodiscard]] Colour pixel(int x, int y) const;

  /// What lies outside the picture is left out.
  void set_pixel(int x, int y, Colour colour);

  /// Writes the PNG. Throws `OutputError` where the file cannot be written; the file appears only when complete.
  void write_png(const std::filesystem::path& path) const;
  /// Writes the PNG's bytes; errors show in the stream's state.
  void write_png(std::ostream& stream) const;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  int width_;
  int height_;
  std::vector<Colour> pixels_;  // row by row, from the top
};

}  // namespace dcem::io
