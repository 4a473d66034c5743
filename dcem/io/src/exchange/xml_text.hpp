#pragma once
/// Text within XML. Private to dcem::io.
#include <string>
#include <string_view>

namespace dcem::io {

/// As XML 1.0 wants it in elements and in quoted attributes; characters that it knows no way to hold become U+FFFD.
inline std::string xml_text(std::string_view text) {
  std::string escaped;
  for (const char character : text) {
    const auto byte = static_cast<unsigned char>(character);
    if (character == '&') {
      escaped += "&amp;";
    } else if (character == '<') {
      escaped += "&lt;";
    } else if (character == '>') {
      escaped += "&gt;";
    } else if (character == '"') {
      escaped += "&quot;";
    } else if (byte < 0x20 && character != '\t' && character != '\n') {
      escaped += "\xef\xbf\xbd";
    } else {
      escaped.push_back(character);
    }
  }
  return escaped;
}

}  // namespace dcem::io
