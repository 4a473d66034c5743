#pragma once
/// Values that JSON has no word for. Private to dcem::io.
#include <nlohmann/json.hpp>
#include <optional>

#include "dcem/geometry/vector.hpp"

namespace dcem::io {

/// null where there is none.
template <typename Value>
nlohmann::ordered_json optional_json(const std::optional<Value>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json(nullptr);
}

inline nlohmann::ordered_json point_json(const Vec3& point_m) {
  return {point_m.x, point_m.y, point_m.z};
}

}  // namespace dcem::io
