#pragma once
/// What tests ask of pictures in any format: whether they are sound, and what was drawn on a canvas.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "dcem/io/src/pictures/canvas.hpp"
#include "tests/io/temporary_folder.hpp"

namespace dcem::test {

/// Read by Python's parser.
inline bool is_xml(const std::filesystem::path& file) {
  const std::string command = "python3 -c \"import sys, xml.dom.minidom as d; d.parse(sys.argv[1])\" '";
  return std::system((command + file.string() + "' > /dev/null 2> /dev/null").c_str()) == 0;
}

/// Its head, its end, and a table of objects where the end says that it is.
inline bool is_pdf(const std::string& bytes) {
  const std::size_t mark = bytes.rfind("startxref\n");
  if (!bytes.starts_with("%PDF-1.") || mark == std::string::npos || !bytes.ends_with("%%EOF\n")) return false;
  const std::size_t table = std::stoul(bytes.substr(mark + 10));
  return table < mark && (bytes.compare(table, 4, "xref") == 0 || bytes.substr(table, 20).find(" 0 obj") < 20);
}

/// Keeps what is drawn.
class RecordedCanvas final : public io::Canvas {
 public:
  struct Line {
    std::vector<io::PixelPoint> points;
    io::Stroke stroke;
  };
  struct Text {
    io::TextPlace place;
    std::string text;
    io::TextStyle style;
  };

  void clip(std::span<const io::PixelRect>) override {}
  void unclip() override {}
  void fill(const io::PixelRect&, io::Colour, double) override {}
  void fill_polygon(std::span<const io::PixelPoint>, io::Colour) override {}
  void fill_disc(io::PixelPoint centre, double, io::Colour) override { discs.push_back(centre); }
  void draw_line(std::span<const io::PixelPoint> points, const io::Stroke& stroke, bool) override {
    lines.push_back({{points.begin(), points.end()}, stroke});
  }
  void draw_segments(std::span<const io::Segment> segments, const io::Stroke& stroke) override {
    for (const io::Segment& segment : segments) lines.push_back({{segment[0], segment[1]}, stroke});
  }
  void draw_image(int, int, const io::Image&) override {}
  void draw_text(const io::TextPlace& place, std::string_view text, const io::TextStyle& style) override {
    texts.push_back({place, std::string(text), style});
  }

  long count(const std::string& text) const {
    return std::count_if(texts.begin(), texts.end(), [&](const Text& one) { return one.text == text; });
  }

  std::vector<Line> lines;
  std::vector<Text> texts;
  std::vector<io::PixelPoint> discs;
};

/// Where a text takes up room, roughly: its length and the height of capitals, upright or lying.
inline io::PixelRect area_of(const RecordedCanvas::Text& text) {
  const int length = static_cast<int>(io::text_width_px(text.text, text.style));
  const int height = static_cast<int>(text.style.capital_px());
  const int before = text.place.anchor == io::Anchor::left    ? 0
                     : text.place.anchor == io::Anchor::right ? length
                                                              : length / 2;
  const int x = static_cast<int>(text.place.at.x), y = static_cast<int>(text.place.at.y);
  if (text.place.direction == io::TextDirection::rightwards) return {x - before, y - height / 2, length, height};
  return {x - height / 2, y + before - length, height, length};
}

}  // namespace dcem::test
