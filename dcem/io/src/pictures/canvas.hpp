#pragma once
/// What every picture is drawn on, whatever it is written as. Private to dcem::io.
///
/// Lengths are in pixels of the PNG; y grows downwards. SVG and PDF have 192 of these to the inch, so that letters of
/// 28 px are 10.5 pt high on paper.
#include <array>
#include <functional>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/image.hpp"
#include "dcem/io/picture_format.hpp"

namespace dcem::io {

/// A line's look. Its ends are round, but for dashes.
struct Stroke {
  Colour colour;
  double width_px = 2.0;
  double opacity = 1.0;             ///< 0…1: how much of what lies below is covered
  std::vector<double> dashes_px{};  ///< lengths of line and gap in turn; empty: a full line
};

/// From one point to another.
using Segment = std::array<PixelPoint, 2>;

struct TextStyle {
  double size_px = 28.0;
  bool bold = false;
  Colour colour{30, 30, 30};

  /// From the foot of the letters to the top of capitals and digits, in DejaVu Sans.
  double capital_px() const { return 0.73 * size_px; }
  /// From the foot to the end of what hangs below, as of a 'g'.
  double descent_px() const { return 0.24 * size_px; }
};

/// Which part of a text stands at its place.
enum class Anchor { left, middle, right };
enum class TextDirection { rightwards, upwards };

/// Where a text stands: capitals are centred about the place across the direction of writing.
struct TextPlace {
  PixelPoint at;
  Anchor anchor = Anchor::left;
  TextDirection direction = TextDirection::rightwards;
};

class Canvas {
 public:
  virtual ~Canvas() = default;

  /// Limits drawing to what lies in any of the areas, until `unclip`. Clips do not nest.
  virtual void clip(std::span<const PixelRect> areas) = 0;
  virtual void unclip() = 0;

  virtual void fill(const PixelRect& area, Colour colour, double opacity = 1.0) = 0;
  virtual void fill_polygon(std::span<const PixelPoint> corners, Colour colour) = 0;
  virtual void fill_disc(PixelPoint centre, double radius_px, Colour colour) = 0;
  /// A line through the points; `closed` leads back to the first.
  virtual void draw_line(std::span<const PixelPoint> points, const Stroke& stroke, bool closed = false) = 0;
  /// Lines of two points each; where they overlap they cover no more than one of them.
  virtual void draw_segments(std::span<const Segment> segments, const Stroke& stroke) = 0;
  /// The image's pixels are those of the picture, its upper left corner at whole pixels.
  virtual void draw_image(int x, int y, const Image& image) = 0;
  /// UTF-8 on one line; what is no UTF-8 shows as '?', control characters as blanks.
  virtual void draw_text(const TextPlace& place, std::string_view text, const TextStyle& style) = 0;
};

/// Length of a text along its direction. Without Cairo an estimate.
double text_width_px(std::string_view text, const TextStyle& style);

/// The text as it can be drawn: valid UTF-8 without control characters.
std::string drawable_text(std::string_view text);

/// What a picture is beside its lines.
struct PictureSheet {
  int width_px = 0;
  int height_px = 0;
  std::string_view title;  ///< of a PDF, for its readers' lists
};

/// Draws a picture on white and writes it. The bytes depend on what is drawn, and on the fonts that are installed.
/// Without Cairo it throws std::logic_error; errors of the stream show in its state.
void draw_picture(std::ostream& stream, PictureFormat format, const PictureSheet& sheet,
                  const std::function<void(Canvas&)>& draw);

/// Throws `OutputError` where this build cannot draw.
void require_drawing(const AtomicFile& file);

/// A frame around an area, its line centred `outside_px` beyond the rim.
void draw_frame(Canvas& canvas, const PixelRect& area, const Stroke& stroke, double outside_px);

}  // namespace dcem::io
