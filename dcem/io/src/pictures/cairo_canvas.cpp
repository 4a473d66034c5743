// The canvas that is drawn on with Cairo. Compiled only where Cairo is.
#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>

#include "dcem/io/src/pictures/canvas.hpp"
#include "dcem/io/src/pictures/svg_names.hpp"

namespace dcem::io {
namespace {

constexpr double points_per_px = 72.0 / 192.0;
// By name; where it is not installed, fontconfig takes what comes nearest.
constexpr const char* font_name = "DejaVu Sans";

template <auto destroy>
struct CairoDeleter {
  template <typename Object>
  void operator()(Object* object) const {
    destroy(object);
  }
};
using CairoSurface = std::unique_ptr<cairo_surface_t, CairoDeleter<cairo_surface_destroy>>;
using CairoContext = std::unique_ptr<cairo_t, CairoDeleter<cairo_destroy>>;
using CairoFontOptions = std::unique_ptr<cairo_font_options_t, CairoDeleter<cairo_font_options_destroy>>;

void require_success(cairo_status_t status) {
  if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
  if (status != CAIRO_STATUS_SUCCESS && status != CAIRO_STATUS_WRITE_ERROR) {
    throw std::runtime_error(std::string("Cairo: ") + cairo_status_to_string(status));
  }
}

cairo_status_t write_bytes(void* stream, const unsigned char* bytes, unsigned int size) {
  std::ostream& out = *static_cast<std::ostream*>(stream);
  return out.write(reinterpret_cast<const char*>(bytes), size) ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

// Outlines as they are, whatever the user's settings for the screen: the same picture everywhere.
void set_font_options(cairo_t* context) {
  const CairoFontOptions options(cairo_font_options_create());
  cairo_font_options_set_antialias(options.get(), CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options.get(), CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options.get(), CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(context, options.get());
}

void set_font(cairo_t* context, const TextStyle& style) {
  cairo_select_font_face(context, font_name, CAIRO_FONT_SLANT_NORMAL,
                         style.bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context, style.size_px);
}

double advance_px(cairo_t* context, const std::string& text) {
  cairo_text_extents_t extents{};
  cairo_text_extents(context, text.c_str(), &extents);
  return extents.x_advance;
}

CairoSurface surface_of(const Image& image) {
  CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width(), image.height()));
  require_success(cairo_surface_status(surface.get()));
  unsigned char* const bytes = cairo_image_surface_get_data(surface.get());
  const int row_bytes = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Colour colour = image.pixel(x, y);
      const std::uint32_t word =
          static_cast<std::uint32_t>(colour.red) << 16U | static_cast<std::uint32_t>(colour.green) << 8U | colour.blue;
      std::memcpy(bytes + static_cast<std::ptrdiff_t>(y) * row_bytes + 4 * x, &word, sizeof word);
    }
  }
  cairo_surface_mark_dirty(surface.get());
  return surface;
}

class CairoCanvas final : public Canvas {
 public:
  CairoCanvas(cairo_surface_t* surface, double scale) : context_(cairo_create(surface)) {
    cairo_scale(get(), scale, scale);
    cairo_set_line_cap(get(), CAIRO_LINE_CAP_ROUND);
    cairo_set_line_join(get(), CAIRO_LINE_JOIN_ROUND);
    set_font_options(get());
    cairo_set_source_rgb(get(), 1.0, 1.0, 1.0);
    cairo_paint(get());
  }

  cairo_t* get() const { return context_.get(); }

  void clip(std::span<const PixelRect> areas) override {
    for (const PixelRect& area : areas) cairo_rectangle(get(), area.x, area.y, area.width, area.height);
    cairo_clip(get());
  }
  void unclip() override { cairo_reset_clip(get()); }

  void fill(const PixelRect& area, Colour colour, double opacity) override {
    set_colour(colour, opacity);
    cairo_rectangle(get(), area.x, area.y, area.width, area.height);
    cairo_fill(get());
  }
  void fill_polygon(std::span<const PixelPoint> corners, Colour colour) override {
    set_colour(colour, 1.0);
    trace(corners);
    cairo_fill(get());
  }
  void fill_disc(PixelPoint centre, double radius_px, Colour colour) override {
    set_colour(colour, 1.0);
    cairo_arc(get(), centre.x, centre.y, radius_px, 0.0, 2.0 * std::numbers::pi);
    cairo_fill(get());
  }
  void draw_line(std::span<const PixelPoint> points, const Stroke& stroke, bool closed) override;
  void draw_segments(std::span<const Segment> segments, const Stroke& stroke) override;
  void draw_image(int x, int y, const Image& image) override;
  void draw_text(const TextPlace& place, std::string_view text, const TextStyle& style) override;

 private:
  void set_stroke(const Stroke& stroke);
  void set_colour(Colour colour, double opacity) {
    cairo_set_source_rgba(get(), colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0, opacity);
  }
  void trace(std::span<const PixelPoint> points) {
    for (const PixelPoint& point : points) cairo_line_to(get(), point.x, point.y);
  }

  CairoContext context_;
};

void CairoCanvas::set_stroke(const Stroke& stroke) {
  set_colour(stroke.colour, stroke.opacity);
  cairo_set_line_width(get(), stroke.width_px);
  cairo_set_line_cap(get(), stroke.dashes_px.empty() ? CAIRO_LINE_CAP_ROUND : CAIRO_LINE_CAP_BUTT);
  cairo_set_dash(get(), stroke.dashes_px.data(), static_cast<int>(stroke.dashes_px.size()), 0.0);
}

void CairoCanvas::draw_line(std::span<const PixelPoint> points, const Stroke& stroke, bool closed) {
  set_stroke(stroke);
  trace(points);
  if (closed) cairo_close_path(get());
  cairo_stroke(get());
}

void CairoCanvas::draw_segments(std::span<const Segment> segments, const Stroke& stroke) {
  set_stroke(stroke);
  for (const auto& [from, to] : segments) {
    cairo_move_to(get(), from.x, from.y);
    cairo_line_to(get(), to.x, to.y);
  }
  cairo_stroke(get());
}

void CairoCanvas::draw_image(int x, int y, const Image& image) {
  const CairoSurface surface = surface_of(image);
  cairo_set_source_surface(get(), surface.get(), x, y);
  cairo_pattern_set_filter(cairo_get_source(get()), CAIRO_FILTER_NEAREST);
  cairo_rectangle(get(), x, y, image.width(), image.height());
  cairo_fill(get());
}

void CairoCanvas::draw_text(const TextPlace& place, std::string_view text, const TextStyle& style) {
  const std::string drawn = drawable_text(text);
  set_font(get(), style);
  set_colour(style.colour, 1.0);
  const double share = place.anchor == Anchor::left ? 0.0 : place.anchor == Anchor::middle ? 0.5 : 1.0;
  cairo_save(get());
  cairo_translate(get(), place.at.x, place.at.y);
  if (place.direction == TextDirection::upwards) cairo_rotate(get(), -0.5 * std::numbers::pi);
  cairo_move_to(get(), -share * advance_px(get(), drawn), 0.5 * style.capital_px());
  cairo_show_text(get(), drawn.c_str());
  cairo_new_path(get());  // a text leaves a point behind, from which the next line would begin
  cairo_restore(get());
}

void draw_on(cairo_surface_t* surface, double scale, const std::function<void(Canvas&)>& draw) {
  require_success(cairo_surface_status(surface));
  CairoCanvas canvas(surface, scale);
  draw(canvas);
  require_success(cairo_status(canvas.get()));
}

void draw_png(std::ostream& stream, const PictureSheet& sheet, const std::function<void(Canvas&)>& draw) {
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, sheet.width_px, sheet.height_px));
  draw_on(surface.get(), 1.0, draw);
  require_success(cairo_surface_write_to_png_stream(surface.get(), write_bytes, &stream));
}

void draw_svg(std::ostream& stream, const PictureSheet& sheet, const std::function<void(Canvas&)>& draw) {
  std::ostringstream text;
  const CairoSurface surface(cairo_svg_surface_create_for_stream(
      write_bytes, static_cast<std::ostream*>(&text), sheet.width_px * points_per_px, sheet.height_px * points_per_px));
  draw_on(surface.get(), points_per_px, draw);
  cairo_surface_finish(surface.get());
  require_success(cairo_surface_status(surface.get()));
  stream << with_own_names(text.str());
}

void draw_pdf(std::ostream& stream, const PictureSheet& sheet, const std::function<void(Canvas&)>& draw) {
  const CairoSurface surface(cairo_pdf_surface_create_for_stream(write_bytes, &stream, sheet.width_px * points_per_px,
                                                                 sheet.height_px * points_per_px));
  // Without a date: the bytes are those of the picture.
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE, drawable_text(sheet.title).c_str());
  draw_on(surface.get(), points_per_px, draw);
  cairo_surface_finish(surface.get());
  require_success(cairo_surface_status(surface.get()));
}

}  // namespace

bool can_draw() {
  return true;
}

std::string drawing_library() {
  return std::string("Cairo ") + cairo_version_string();
}

double text_width_px(std::string_view text, const TextStyle& style) {
  const CairoSurface surface(cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1));
  const CairoContext context(cairo_create(surface.get()));
  set_font_options(context.get());
  set_font(context.get(), style);
  const double width_px = advance_px(context.get(), drawable_text(text));
  require_success(cairo_status(context.get()));
  return width_px;
}

void draw_picture(std::ostream& stream, PictureFormat format, const PictureSheet& sheet,
                  const std::function<void(Canvas&)>& draw) {
  switch (format) {
    case PictureFormat::png:
      return draw_png(stream, sheet, draw);
    case PictureFormat::svg:
      return draw_svg(stream, sheet, draw);
    case PictureFormat::pdf:
      return draw_pdf(stream, sheet, draw);
  }
}

}  // namespace dcem::io
