#pragma once
/// Devices by their ids.
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <unordered_map>

#include "dcem/scene/device.hpp"

namespace dcem::detail {

using DeviceNumbers = std::unordered_map<std::string, std::uint32_t>;

/// Their places in a list, by id.
inline DeviceNumbers numbers_by_id(std::span<const Device> devices) {
  DeviceNumbers numbers;
  for (std::size_t index = 0; index < devices.size(); ++index) {
    numbers.emplace(devices[index].id, static_cast<std::uint32_t>(index));
  }
  return numbers;
}

}  // namespace dcem::detail
