#pragma once
/// Ids as parts of file names. Private to dcem::io.
#include <string>
#include <string_view>

namespace dcem::io {

inline bool fits_file_name(unsigned char character) {
  constexpr std::string_view separators = "/\\:*?\"<>|%";
  return character >= 32 && character != 127 && separators.find(static_cast<char>(character)) == std::string_view::npos;
}

/// The id with every character that a file name cannot hold as % and two hexadecimal digits.
inline std::string file_name_part(std::string_view id) {
  constexpr std::string_view hexadecimal = "0123456789ABCDEF";
  std::string part;
  for (const char character : id) {
    const auto byte = static_cast<unsigned char>(character);
    if (fits_file_name(byte)) {
      part.push_back(character);
    } else {
      part.append({'%', hexadecimal[byte / 16], hexadecimal[byte % 16]});
    }
  }
  return part;
}

}  // namespace dcem::io
