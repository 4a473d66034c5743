#pragma once
/// Instants of a scenario as dates. Private to dcem::io.
#include <optional>
#include <string>

namespace dcem::io {

/// Microseconds since 1970 of "2000-01-01T00:00:00Z", an instant as ISO 8601 and RFC 3339 write it; nothing for any
/// other text.
std::optional<long long> calendar_microseconds(const std::string& text);

/// The same backwards, with as many decimals of a second as it takes, six at most.
std::string calendar_text(long long microseconds);

}  // namespace dcem::io
