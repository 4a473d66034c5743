#include "dcem/io/image.hpp"

#include <doctest/doctest.h>

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

}  // namespace test_image
