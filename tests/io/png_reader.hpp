#pragma once
/// Reads PNG files back with stb_image, so that tests look at what a user would see and not at the canvas.
#include <stb/stb_image.h>

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "dcem/io/image.hpp"

namespace dcem::test {

struct Png {
  int width = 0;
  int height = 0;
  std::vector<io::Colour> pixels;  // row by row, from the top

  io::Colour at(int x, int y) const {
    if (x < 0 || y < 0 || x >= width || y >= height) throw std::out_of_range("no such pixel");
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

inline Png read_png(const std::filesystem::path& path) {
  Png png;
  int channels = 0;
  stbi_uc* const bytes = stbi_load(path.c_str(), &png.width, &png.height, &channels, 3);
  if (bytes == nullptr) throw std::runtime_error(path.string() + " is no PNG");
  const std::size_t count = static_cast<std::size_t>(png.width) * static_cast<std::size_t>(png.height);
  for (std::size_t i = 0; i < count; ++i) png.pixels.push_back({bytes[3 * i], bytes[3 * i + 1], bytes[3 * i + 2]});
  stbi_image_free(bytes);
  return png;
}

}  // namespace dcem::test
