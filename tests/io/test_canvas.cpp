/// What every picture is drawn on, read back from its PNG.
#include "dcem/io/src/pictures/canvas.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "dcem/io/src/pictures/svg_names.hpp"
#include "tests/io/drawing_needed.hpp"
#include "tests/io/picture_checks.hpp"
#include "tests/io/png_reader.hpp"

namespace test_canvas {

using namespace dcem::io;
using dcem::test::Png;
using dcem::test::TemporaryFolder;

namespace {

constexpr Colour black{0, 0, 0};

Png drawn(int width_px, int height_px, const std::function<void(Canvas&)>& draw) {
  const TemporaryFolder folder;
  AtomicFile file(folder / "a.png");
  draw_picture(file.stream(), PictureFormat::png, {width_px, height_px, "a"}, draw);
  file.commit();
  return dcem::test::read_png(folder / "a.png");
}

// How much black lies on white, in pixels.
double ink_px(const Png& png) {
  double ink = 0.0;
  for (const Colour& colour : png.pixels) ink += (255.0 - colour.red) / 255.0;
  return ink;
}

std::string bytes_of(PictureFormat format, const std::function<void(Canvas&)>& draw) {
  std::ostringstream stream;
  draw_picture(stream, format, {300, 200, "one"}, draw);
  return stream.str();
}

void draw_some(Canvas& canvas) {
  Image image(4, 4, {10, 200, 30});
  canvas.draw_image(10, 10, image);
  canvas.draw_text({{100.0, 100.0}}, "0.5 dBm", {});
  canvas.fill({50, 50, 20, 20}, {200, 0, 0}, 0.5);
}

}  // namespace

TEST_CASE("a line carries as much ink as its area, at every angle") {
  DCEM_NEEDS_DRAWING();
  for (int angle_deg = 0; angle_deg < 360; angle_deg += 17) {
    const double angle_rad = angle_deg * std::numbers::pi / 180.0;
    const std::array<PixelPoint, 2> line{
        {{100.3, 99.8}, {100.3 + 80.0 * std::cos(angle_rad), 99.8 + 80.0 * std::sin(angle_rad)}}};
    const Png png = drawn(200, 200, [&](Canvas& canvas) { canvas.draw_line(line, {black, 6.0}); });
    CHECK(ink_px(png) == doctest::Approx(80.0 * 6.0 + std::numbers::pi * 9.0).epsilon(0.02));
  }
}

TEST_CASE("a disc has the area of a circle, and half the opacity half the ink") {
  DCEM_NEEDS_DRAWING();
  const Png disc = drawn(80, 80, [](Canvas& canvas) { canvas.fill_disc({40.2, 39.7}, 20.0, black); });
  CHECK(ink_px(disc) == doctest::Approx(std::numbers::pi * 400.0).epsilon(0.005));
  const Png pale = drawn(80, 80, [](Canvas& canvas) { canvas.fill({10, 10, 20, 30}, black, 0.5); });
  CHECK(ink_px(pale) == doctest::Approx(300.0).epsilon(0.005));
}

TEST_CASE("segments that overlap cover no more than one of them, however pale") {
  DCEM_NEEDS_DRAWING();
  const Segment level{{{10.0, 30.0}, {60.0, 30.0}}}, part{{{20.0, 30.0}, {40.0, 30.0}}};
  const auto ink_of = [](std::span<const Segment> segments) {
    return ink_px(drawn(80, 60, [&](Canvas& canvas) { canvas.draw_segments(segments, {black, 6.0, 0.35}); }));
  };
  const std::vector<Segment> alone{level}, both{level, part, part};
  CHECK(ink_of(alone) == doctest::Approx(0.35 * (50.0 * 6.0 + std::numbers::pi * 9.0)).epsilon(0.02));
  CHECK(ink_of(both) == doctest::Approx(ink_of(alone)).epsilon(0.002));
}

TEST_CASE("nothing is drawn outside the areas of a clip, and all of it again behind") {
  DCEM_NEEDS_DRAWING();
  const std::array<PixelRect, 2> areas{{{10, 10, 5, 5}, {30, 20, 4, 4}}};
  const Png png = drawn(60, 40, [&](Canvas& canvas) {
    canvas.clip(areas);
    canvas.fill({0, 0, 60, 40}, black);
    canvas.unclip();
    canvas.fill({50, 0, 2, 2}, black);
  });
  CHECK(ink_px(png) == doctest::Approx(25.0 + 16.0 + 4.0));
}

TEST_CASE("lines, discs and texts do not hang together") {
  DCEM_NEEDS_DRAWING();
  const auto line = [](Canvas& canvas) {
    canvas.draw_line(std::array{PixelPoint{10.0, 190.0}, PixelPoint{40.0, 190.0}}, {black, 2.0});
  };
  const auto text = [](Canvas& canvas) { canvas.draw_text({{200.0, 20.0}}, "text", {}); };
  const auto disc = [](Canvas& canvas) { canvas.fill_disc({250.0, 150.0}, 10.0, black); };
  const double apart = ink_px(drawn(300, 200, line)) + ink_px(drawn(300, 200, text)) + ink_px(drawn(300, 200, disc));
  const Png together = drawn(300, 200, [&](Canvas& canvas) { text(canvas), line(canvas), disc(canvas), line(canvas); });
  // The second line lies upon the first; where its rim is half covered it covers half of what is left.
  CHECK(ink_px(together) == doctest::Approx(apart).epsilon(0.01));
}

TEST_CASE("a text takes the room that is said, whichever end it is put by, and is turned by a right angle") {
  DCEM_NEEDS_DRAWING();
  const std::string text = "H received power (dBm) H";  // begins and ends with an upright stroke
  const TextStyle style{26.0};
  const double width_px = text_width_px(text, style);
  const auto columns = [&](Anchor anchor) {
    const Png png = drawn(1000, 60, [&](Canvas& canvas) { canvas.draw_text({{500.0, 30.0}, anchor}, text, style); });
    int first = 1000, last = 0, top = 60, bottom = 0;
    for (int y = 0; y < 60; ++y) {
      for (int x = 0; x < 1000; ++x) {
        if (png.at(x, y).red > 128) continue;
        first = std::min(first, x), last = std::max(last, x), top = std::min(top, y), bottom = std::max(bottom, y);
      }
    }
    CHECK(last - first == doctest::Approx(width_px).epsilon(0.03));
    return std::array{first, last, top, bottom};
  };
  CHECK(std::abs(columns(Anchor::left)[0] - 500) < 6);
  CHECK(std::abs(columns(Anchor::right)[1] - 500) < 6);
  CHECK(std::abs(columns(Anchor::middle)[0] + columns(Anchor::middle)[1] - 1000) < 6);
  const auto level = [&](Canvas& canvas) { canvas.draw_text({{500.0, 500.0}, Anchor::middle}, text, style); };
  const auto upright = [&](Canvas& canvas) {
    canvas.draw_text({{500.0, 500.0}, Anchor::middle, TextDirection::upwards}, text, style);
  };
  const Png one = drawn(1000, 1000, level), other = drawn(1000, 1000, upright);
  CHECK(ink_px(one) == doctest::Approx(ink_px(other)).epsilon(0.01));
  CHECK(ink_px(one) > 500.0);
  int different = 0;
  for (int y = 0; y < 1000; ++y) {
    for (int x = 0; x < 1000; ++x) different += std::abs(one.at(x, y).red - other.at(y, 999 - x).red) > 64 ? 1 : 0;
  }
  CHECK(different < 20);
}

TEST_CASE("an image's pixels are those of the PNG, one by one") {
  DCEM_NEEDS_DRAWING();
  Image image(50, 20);
  for (int i = 0; i < 1000; ++i) {
    const auto byte = [i](int factor) { return static_cast<std::uint8_t>(i * factor % 256); };
    image.set_pixel(i % 50, i / 50, {byte(7), byte(13), byte(31)});
  }
  const Png png = drawn(80, 40, [&](Canvas& canvas) { canvas.draw_image(11, 7, image); });
  int different = 0;
  for (int i = 0; i < 1000; ++i) different += png.at(11 + i % 50, 7 + i / 50) == image.pixel(i % 50, i / 50) ? 0 : 1;
  CHECK(different == 0);
}

TEST_CASE("every format gives the same bytes again, whatever was drawn between, and holds no date") {
  DCEM_NEEDS_DRAWING();
  for (const PictureFormat format : {PictureFormat::png, PictureFormat::svg, PictureFormat::pdf}) {
    const std::string first = bytes_of(format, draw_some);
    const std::string other = bytes_of(format, [](Canvas& canvas) { canvas.fill({0, 0, 9, 9}, black); });
    CHECK(first == bytes_of(format, draw_some));
    CHECK(first != other);
    CHECK(first.find("CreationDate") == std::string::npos);
  }
  CHECK(dcem::test::is_pdf(bytes_of(PictureFormat::pdf, draw_some)));
  CHECK(bytes_of(PictureFormat::svg, draw_some).find("width=\"112.5pt\"") != std::string::npos);  // 300 of 192 an inch
}

TEST_CASE("names in an SVG are numbered as they stand, and references follow them") {
  CHECK(with_own_names("<g id=\"surface7\"><use xlink:href=\"#surface7\"/><p id=\"c\" fill=\"url(#c)\"/>#c #d</g>") ==
        "<g id=\"n0\"><use xlink:href=\"#n0\"/><p id=\"n1\" fill=\"url(#n1)\"/>#c #d</g>");
}

TEST_CASE("what is no UTF-8 is drawn as a question mark, and what is no letter as a blank") {
  CHECK(drawable_text("a\xc2\xb5 \xe2\x82\xac \xf0\x9f\x98\x80") == "a\xc2\xb5 \xe2\x82\xac \xf0\x9f\x98\x80");
  CHECK(drawable_text("\xb5|\xc2|\xe2\x82|\xff") == "?|?|??|?");
  CHECK(drawable_text("\xc0\x80\xed\xa0\x80\xf5\x80") == "???????");  // overlong, half a pair, beyond Unicode
  CHECK(drawable_text(std::string_view("a\nb\0c\x7f", 6)) == "a b c ");
}

TEST_CASE("a file's ending says its format") {
  CHECK(picture_format_of("a/b.c/map.pdf") == PictureFormat::pdf);
  CHECK(picture_format_of("map.svg") == PictureFormat::svg);
  for (const char* name : {"map", "map.", "map.gif", "map.PNG", ""}) {
    CHECK_THROWS_AS((void)picture_format_of(name), std::invalid_argument);
  }
  CHECK(formats_or({}, PictureFormat::svg) == std::vector{PictureFormat::svg});
  CHECK(formats_or(std::vector<PictureFormat>{}, PictureFormat::svg).empty());
}

TEST_CASE("a build that cannot draw says so, and throws where it is asked to") {
  std::ostringstream stream;
  if (can_draw()) {
    CHECK(drawing_library().starts_with("Cairo "));
  } else {
    CHECK(drawing_library().find("no Cairo") != std::string::npos);
    CHECK_THROWS_AS(draw_picture(stream, PictureFormat::svg, {10, 10, "a"}, draw_some), std::logic_error);
  }
}

}  // namespace test_canvas
