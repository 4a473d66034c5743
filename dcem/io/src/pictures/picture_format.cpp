#include "dcem/io/picture_format.hpp"

#include <array>
#include <stdexcept>
#include <utility>

namespace dcem::io {
namespace {

constexpr std::array<std::pair<PictureFormat, std::string_view>, 3> format_words{
    {{PictureFormat::png, "png"}, {PictureFormat::svg, "svg"}, {PictureFormat::pdf, "pdf"}}};

}  // namespace

std::string_view word_of(PictureFormat format) {
  return format_words[static_cast<std::size_t>(format)].second;
}

std::optional<PictureFormat> picture_format(std::string_view word) {
  for (const auto& [format, its_word] : format_words) {
    if (word == its_word) return format;
  }
  return std::nullopt;
}

PictureFormat picture_format_of(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (const auto format = picture_format(std::string_view(ending).substr(ending.empty() ? 0 : 1))) return *format;
  throw std::invalid_argument(file.string() + ": no picture; expected a name that ends with .png, .svg or .pdf");
}

std::vector<PictureFormat> formats_or(const PictureFormats& formats, PictureFormat usual) {
  return formats ? *formats : std::vector{usual};
}

}  // namespace dcem::io
