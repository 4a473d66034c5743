#pragma once
/// Texts in UTF-8 as characters, for formats that count them. Private to dcem::io.
#include <string>
#include <string_view>

namespace dcem::io {

/// Throws std::invalid_argument where a text is not UTF-8 (RFC 3629: no surrogates, no longer form than needed).
std::u32string decoded(std::string_view text);

/// The same in UTF-16 (RFC 2781).
std::u16string utf16(std::string_view text);

}  // namespace dcem::io
