// In place of cairo_canvas.cpp where there is no Cairo.
#include <stdexcept>

#include "dcem/io/src/pictures/canvas.hpp"
#include "dcem/io/text_table.hpp"

namespace dcem::io {

bool can_draw() {
  return false;
}

std::string drawing_library() {
  return "nothing (no Cairo): maps as plain rasters, no charts";
}

double text_width_px(std::string_view text, const TextStyle& style) {
  constexpr double mean_letter = 0.6;  // of the size
  return mean_letter * style.size_px * static_cast<double>(character_count(text));
}

void draw_picture(std::ostream&, PictureFormat, const PictureSheet&, const std::function<void(Canvas&)>&) {
  throw std::logic_error("draw_picture: " + std::string(no_drawing) + "; expected " + std::string(drawing_expected));
}

}  // namespace dcem::io
