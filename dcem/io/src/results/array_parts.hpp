#pragma once
/// What the archives of arrays have in common. Private to dcem::io.
#include <span>
#include <string>
#include <vector>

#include "dcem/scene/device.hpp"

namespace dcem::io {

/// More is refused before anything is gathered.
inline constexpr double most_array_bytes = 16e9;

inline std::vector<std::string> ids_of(std::span<const Device> devices) {
  std::vector<std::string> ids;
  for (const Device& device : devices) ids.push_back(device.id);
  return ids;
}

}  // namespace dcem::io
