#include "dcem/io/image.hpp"

#include <stb/stb_image_write.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <stdexcept>
#include <string>

#include "dcem/core/error.hpp"
#include "dcem/io/atomic_file.hpp"

namespace dcem::io {
namespace {

constexpr int max_side_px = 32768;

}  // namespace

Colour mix(Colour from, Colour to, double share) {
  const auto channel = [share](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(a + std::clamp(share, 0.0, 1.0) * (b - a)));
  };
  return {channel(from.red, to.red), channel(from.green, to.green), channel(from.blue, to.blue)};
}

PixelRect intersection(const PixelRect& first, const PixelRect& second) {
  const int x = std::max(first.x, second.x);
  const int y = std::max(first.y, second.y);
  return {x, y, std::max(0, std::min(first.right(), second.right()) - x),
          std::max(0, std::min(first.bottom(), second.bottom()) - y)};
}

Image::Image(int width, int height, Colour background) : width_(width), height_(height) {
  if (width < 1 || height < 1 || width > max_side_px || height > max_side_px) {
    throw std::invalid_argument("Image: " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels; expected 1 to " + std::to_string(max_side_px) + " on each side");
  }
  pixels_.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), background);
}

Colour Image::pixel(int x, int y) const {
  DCEM_ASSERT(bounds().contains(x, y));
  return pixels_[index(x, y)];
}

void Image::set_pixel(int x, int y, Colour colour) {
  if (bounds().contains(x, y)) pixels_[index(x, y)] = colour;
}

void Image::write_png(const std::filesystem::path& path) const {
  AtomicFile file(path);
  write_png(file.stream());
  file.commit();
}

void Image::write_png(std::ostream& stream) const {
  static_assert(sizeof(Colour) == 3, "the pixels are handed to the PNG writer as they lie in memory");
  const auto write = [](void* context, void* bytes, int size) {
    static_cast<std::ostream*>(context)->write(static_cast<const char*>(bytes), size);
  };
  const int row_bytes = 3 * width_;
  if (stbi_write_png_to_func(write, &stream, width_, height_, 3, pixels_.data(), row_bytes) == 0) {
    stream.setstate(std::ios::badbit);
  }
}

}  // namespace dcem::io
