#pragma once
/// A small canvas for pictures of results: 8-bit sRGB pixels, lines, hatching and text, written as PNG.
///
/// Pixel (0, 0) is the upper left one; x grows to the right, y downwards. For lines and discs coordinates are
/// continuous: pixel (x, y) covers the square from (x, y) to (x + 1, y + 1). Whatever lies outside the picture, or
/// outside the clip rectangle where one is set, is left out.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <span>
#include <string_view>
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

/// Parallel lines under 45°. They run on from one hatched rectangle to the next, because they count from pixel (0, 0).
struct Hatch {
  Colour line;
  int pitch_px = 6;      // distance from line to line along a row
  int thickness_px = 1;  // along a row
};

enum class TextDirection { rightwards, upwards };

class Image {
 public:
  /// Throws `std::invalid_argument` unless both sides are 1…32,768 pixels.
  Image(int width, int height, Colour background = {255, 255, 255});

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] PixelRect bounds() const { return {0, 0, width_, height_}; }
  /// Requires a pixel inside the picture.
  [[nodiscard]] Colour pixel(int x, int y) const;

  /// Limits all drawing to the part of `clip` inside the picture, until the next call.
  void set_clip(const PixelRect& clip) { clip_ = intersection(clip, bounds()); }
  void remove_clip() { clip_ = bounds(); }

  void set_pixel(int x, int y, Colour colour);
  void fill_rectangle(const PixelRect& area, Colour colour);
  /// Lays `colour` over an area, `opacity` 0…1.
  void shade_rectangle(const PixelRect& area, Colour colour, double opacity);
  /// A frame one pixel wide, inside the rectangle.
  void draw_frame(const PixelRect& area, Colour colour);
  void hatch_rectangle(const PixelRect& area, const Hatch& hatch);

  /// A smooth (antialiased) line with round ends, `thickness_px` wide. A line with a coordinate that is not finite, or
  /// beyond ±1e12, is left out. `opacity` 0…1: how much of what lies below is covered.
  void draw_line(PixelPoint from, PixelPoint to, Colour colour, double thickness_px = 1.0, double opacity = 1.0);
  /// The closed outline through the corners.
  void draw_polygon(std::span<const PixelPoint> corners, Colour colour, double thickness_px = 1.0);
  void fill_disc(PixelPoint centre, double radius_px, Colour colour);

  /// Text in the fixed font of stb_easy_font, every font dot `scale` pixels wide; (x, y) is the upper left corner of
  /// the area that the text takes on the picture (`text_length_px` × `text_height_px`, turned where it runs upwards).
  /// Characters outside printable ASCII are shown as '?'; '\n' is one of them.
  void draw_text(int x, int y, std::string_view text, Colour colour, int scale,
                 TextDirection direction = TextDirection::rightwards);

  /// Writes the PNG. Throws `OutputError` where the file cannot be written; the file appears only when complete.
  void write_png(const std::filesystem::path& path) const;
  /// Writes the PNG's bytes; errors show in the stream's state.
  void write_png(std::ostream& stream) const;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  void blend_pixel(int x, int y, Colour colour, double opacity);

  int width_;
  int height_;
  PixelRect clip_;
  std::vector<Colour> pixels_;  // row by row, from the top
};

/// Length of a text along its direction, in pixels, without the gap behind the last character.
int text_length_px(std::string_view text, int scale);

/// Height of a line of text from the top of its capitals to the bottom of its descenders, in pixels.
int text_height_px(int scale);

}  // namespace dcem::io
