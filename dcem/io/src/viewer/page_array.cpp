#include "dcem/io/src/viewer/page_array.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace dcem::io {
namespace {

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      group = group << 8 | (i < count ? static_cast<unsigned char>(bytes[at + i]) : 0U);
    }
    for (std::size_t i = 0; i < 4; ++i) text.push_back(i <= count ? digits[group >> (18 - 6 * i) & 63U] : '=');
  }
  return text;
}

}  // namespace

void PageArray::add(float value) {
  append(std::bit_cast<std::uint32_t>(value), 4);
}

void PageArray::add(double value) {
  append(std::bit_cast<std::uint64_t>(value), 8);
}

void PageArray::add(const Vec3& point) {
  for (int axis = 0; axis < 3; ++axis) add(static_cast<float>(point[axis]));
}

void PageArray::number(const std::optional<double>& value) {
  const float single = value ? static_cast<float>(*value) : 0.0F;
  value&& std::isfinite(single) ? add(single) : add(std::uint32_t{0x7fc00000});
}

void PageArray::write(AtomicFile& file, std::string_view name, std::string_view type) const {
  file.write("<script type=\"text/plain\" data-type=\"" + std::string(type) + "\" id=\"" + std::string(name) + "\">");
  constexpr std::size_t piece = 3 * (std::size_t{1} << 18);  // whole groups of base64
  for (std::size_t at = 0; at < bytes_.size(); at += piece)
    file.write(base64(std::string_view(bytes_).substr(at, piece)));
  file.write("</script>\n");
}

void PageArray::append(std::uint64_t bits, int count) {
  for (int byte = 0; byte < count; ++byte) bytes_.push_back(static_cast<char>(bits >> (8 * byte) & 255U));
}

void PageArrays::announce(std::initializer_list<const char*> names_of_counts,
                          std::initializer_list<const char*> names_of_numbers) {
  for (const char* name : names_of_counts) counts(name);
  for (const char* name : names_of_numbers) numbers(name);
}

void PageArrays::write(AtomicFile& file) const {
  for (const auto& [name, entry] : arrays_) entry.array.write(file, name, entry.type);
}

PageArray& PageArrays::array(std::string_view name, std::string_view type) {
  const auto place = arrays_.find(name);
  return place != arrays_.end() ? place->second.array : arrays_.emplace(name, Entry{type, {}}).first->second.array;
}

}  // namespace dcem::io
