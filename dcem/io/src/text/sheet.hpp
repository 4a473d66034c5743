#pragma once
/// Long texts reach their files in pieces. Private to dcem::io.
#include <cstddef>

namespace dcem::io {

/// How much of a text is gathered before it is written.
inline constexpr std::size_t sheet_bytes = std::size_t{1} << 20;

}  // namespace dcem::io
