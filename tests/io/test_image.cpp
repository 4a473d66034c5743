#include "dcem/io/image.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>

#include "dcem/core/error.hpp"
#include "tests/io/png_reader.hpp"
#include "tests/io/temporary_folder.hpp"

namespace test_image {

using namespace dcem::io;
using dcem::test::Png;
using dcem::test::read_png;
using dcem::test::TemporaryFolder;

namespace {

constexpr Colour black{0, 0, 0};
constexpr Colour white{255, 255, 255};

// How much black lies on a white picture, in pixels.
double ink_px(const Image& image) {
  double ink = 0.0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) ink += (255.0 - image.pixel(x, y).red) / 255.0;
  }
  return ink;
}

bool same(const Image& first, const Image& second) {
  if (first.bounds() != second.bounds()) return false;
  for (int y = 0; y < first.height(); ++y) {
    for (int x = 0; x < first.width(); ++x) {
      if (first.pixel(x, y) != second.pixel(x, y)) return false;
    }
  }
  return true;
}

Image with_text(const std::string& text) {
  Image image(120, 30);
  image.draw_text(3, 4, text, black, 2);
  return image;
}

}  // namespace

TEST_CASE("a picture comes back from its PNG pixel by pixel") {
  const TemporaryFolder folder;
  Image image(61, 43, {1, 2, 3});
  for (int i = 0; i < 61 * 43; i += 2) {
    const auto byte = [i](int factor) { return static_cast<std::uint8_t>(i * factor % 256); };
    image.set_pixel(i % 61, i / 61, {byte(7), byte(13), byte(31)});
  }
  image.write_png(folder / "noise.png");
  const Png png = read_png(folder / "noise.png");
  REQUIRE(png.width == 61);
  REQUIRE(png.height == 43);
  int different = 0;
  for (int y = 0; y < 43; ++y) {
    for (int x = 0; x < 61; ++x) different += png.at(x, y) == image.pixel(x, y) ? 0 : 1;
  }
  CHECK(different == 0);
  std::ostringstream stream;
  image.write_png(stream);
  CHECK(stream.str() == dcem::test::file_bytes(folder / "noise.png"));
}

TEST_CASE("a picture that cannot be written leaves nothing") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(Image(4, 4).write_png(folder / "absent/a.png"), std::runtime_error);
  CHECK(folder.names().empty());
}

TEST_CASE("sizes without sense are refused and pixels outside are not read") {
  for (const int side : {0, -5, 32769}) {
    CHECK_THROWS_AS(Image(side, 10), std::invalid_argument);
    CHECK_THROWS_AS(Image(10, side), std::invalid_argument);
  }
  CHECK_THROWS_AS((void)Image(3, 3).pixel(3, 0), dcem::InvariantError);
  CHECK_THROWS_AS((void)Image(3, 3).pixel(0, -1), dcem::InvariantError);
}

TEST_CASE("mixing begins and ends at its colours") {
  const Colour from{10, 200, 0};
  const Colour to{20, 100, 255};
  CHECK(mix(from, to, 0.0) == from);
  CHECK(mix(from, to, 1.0) == to);
  CHECK(mix(from, to, 7.0) == to);
  CHECK(mix(from, to, 0.5) == Colour{15, 150, 128});
}

TEST_CASE("a line carries as much ink as its area, at every angle") {
  for (int angle_deg = 0; angle_deg < 360; angle_deg += 17) {
    for (const double thickness_px : {1.0, 2.0, 5.0, 20.0}) {
      Image image(200, 200);
      const double angle_rad = angle_deg * std::numbers::pi / 180.0;
      const PixelPoint from{100.3, 99.8};
      const PixelPoint to{from.x + 80.0 * std::cos(angle_rad), from.y + 80.0 * std::sin(angle_rad)};
      image.draw_line(from, to, black, thickness_px);
      const double area_px = 80.0 * thickness_px + std::numbers::pi * thickness_px * thickness_px / 4.0;
      // A pixel's share is taken from the distance of its middle to the line, exact along the axes; at 45° the linear
      // ramp is up to 6 % of a one-pixel line off, less for wide ones.
      CHECK(ink_px(image) == doctest::Approx(area_px).epsilon(0.06));
    }
  }
}

TEST_CASE("a line has no direction, and opacity thins it") {
  Image there(60, 60);
  Image back(60, 60);
  there.draw_line({3.2, 50.1}, {47.7, 11.4}, black, 2.0);
  back.draw_line({47.7, 11.4}, {3.2, 50.1}, black, 2.0);
  CHECK(same(there, back));
  Image pale(60, 60);
  pale.draw_line({3.2, 50.1}, {47.7, 11.4}, black, 2.0, 0.5);
  // Half the ink, but for the rounding of each of some 150 pixels to 1/255.
  CHECK(ink_px(pale) == doctest::Approx(0.5 * ink_px(there)).epsilon(0.01));
}

TEST_CASE("a disc has the area of a circle") {
  Image image(80, 80);
  image.fill_disc({40.2, 39.7}, 20.0, black);
  // The smooth rim is symmetric about the radius; what remains is of second order in 1 px / 20 px.
  CHECK(ink_px(image) == doctest::Approx(std::numbers::pi * 400.0).epsilon(0.005));
  CHECK(image.pixel(40, 39) == black);
}

TEST_CASE("a polygon is closed") {
  Image image(50, 50);
  const std::array<PixelPoint, 3> corners{{{10.5, 10.5}, {40.5, 10.5}, {10.5, 40.5}}};
  image.draw_polygon(corners, black);
  CHECK(image.pixel(25, 10) == black);
  CHECK(image.pixel(25, 25) == black);
  CHECK(image.pixel(10, 25) == black);
  CHECK(image.pixel(15, 15) == white);
}

TEST_CASE("whatever lies outside the picture or the clip is left out") {
  Image image(40, 30);
  const double infinity = std::numeric_limits<double>::infinity();
  image.set_clip({10, 10, 5, 5});
  image.draw_line({-1e9, 12.5}, {1e9, 12.5}, black, 1.0);
  image.draw_line({12.5, -1e12}, {12.5, 1e12}, black, 1.0);
  image.draw_line({0.0, -1e300}, {20.0, 1e300}, black, 50.0);
  image.draw_line({0.0, 0.0}, {infinity, 20.0}, black, 50.0);
  image.draw_line({0.0, 0.0}, {std::nan(""), 20.0}, black, 50.0);
  image.fill_rectangle({-100, 14, 1000, 1000}, black);
  // One row and one column of the clip, and its last row.
  CHECK(ink_px(image) == doctest::Approx(5.0 + 4.0 + 4.0));
  image.remove_clip();
  image.draw_text(-300, -5, std::string(200, 'M'), black, 3);
  image.draw_text(35, 25, "far out", black, 3, TextDirection::upwards);
  image.hatch_rectangle({-7, -7, 100, 100}, {black});
  image.shade_rectangle({-7, -7, 100, 100}, black, 1.0);
  CHECK(ink_px(image) == doctest::Approx(40.0 * 30.0));
}

TEST_CASE("hatching runs on from one rectangle to the next") {
  Image whole(60, 40);
  whole.hatch_rectangle({5, 5, 48, 30}, {black, 6, 2});
  Image parts(60, 40);
  for (int y = 5; y < 35; y += 3) {
    for (int x = 5; x < 53; x += 4) parts.hatch_rectangle({x, y, 4, 3}, {black, 6, 2});
  }
  CHECK(same(whole, parts));
  CHECK(ink_px(whole) == doctest::Approx(48.0 * 30.0 * 2.0 / 6.0));  // both sides are multiples of the pitch
}

TEST_CASE("every printable character leaves its own mark, inside the area that its text takes") {
  for (char first = ' '; first <= '~'; ++first) {
    const std::string text(3, first);
    Image image(80, 50);
    image.set_clip({11, 12, text_length_px(text, 2), text_height_px(2)});
    image.draw_text(11, 12, text, black, 2);
    Image unclipped(80, 50);
    unclipped.draw_text(11, 12, text, black, 2);
    CHECK_MESSAGE(same(image, unclipped), text);
    CHECK((ink_px(image) > 0.0) == (first != ' '));
    for (char second = ' '; second < first; ++second) {
      const bool alike = same(with_text(std::string(1, first)), with_text(std::string(1, second)));
      // The font draws a small L and a bar alike.
      CHECK_MESSAGE(alike == (first == '|' && second == 'l'), first << " and " << second);
    }
  }
}

TEST_CASE("text that runs upwards is the same text, turned by a right angle") {
  const std::string text = "received power / dBm";
  const int length = text_length_px(text, 2);
  const int height = text_height_px(2);
  Image flat(length, height);
  flat.draw_text(0, 0, text, black, 2);
  Image upright(height, length);
  upright.draw_text(0, 0, text, black, 2, TextDirection::upwards);
  int different = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < length; ++x) different += flat.pixel(x, y) == upright.pixel(y, length - 1 - x) ? 0 : 1;
  }
  CHECK(different == 0);
  CHECK(ink_px(flat) > 100.0);
}

TEST_CASE("characters that the font lacks become question marks, one each") {
  CHECK(same(with_text("\xC2\xB5V"), with_text("?V")));  // micro sign
  CHECK(same(with_text("a\nb\t"), with_text("a?b?")));
  CHECK(text_length_px("\xE2\x82\xAC", 2) == text_length_px("?", 2));  // euro sign
  CHECK(text_length_px("", 2) == 0);
}

}  // namespace test_image
