#pragma once
/// What the archives of arrays have in common. Private to dcem::io.
#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "dcem/io/text_table.hpp"
#include "dcem/scene/device.hpp"

namespace dcem::io {

/// More is refused before anything is gathered.
inline constexpr double most_array_bytes = 16e9;

/// Throws std::invalid_argument where arrays need more than that, or than the limit of the run. `what` as in
/// "output.npz: the paths of this run", `remedy` as in "fewer frames".
inline void require_array_memory(const std::string& what, double bytes, const std::string& as, double limit_bytes,
                                 const std::string& remedy) {
  if (bytes <= std::min(most_array_bytes, limit_bytes)) return;
  const bool is_by_limit = limit_bytes < most_array_bytes;
  const std::string most = memory_text(is_by_limit ? limit_bytes : most_array_bytes);
  throw std::invalid_argument(what + " need " + memory_text(bytes) + as + "; expected at most " + most +
                              (is_by_limit ? ", the limit of memory (" : " (") + remedy + ")");
}

inline std::vector<std::string> ids_of(std::span<const Device> devices) {
  std::vector<std::string> ids;
  for (const Device& device : devices) ids.push_back(device.id);
  return ids;
}

}  // namespace dcem::io
