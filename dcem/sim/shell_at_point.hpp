#pragma once
/// A closed part of the scene, seen from a point.
#include <compare>
#include <cstdint>

#include "dcem/core/ids.hpp"

namespace dcem {

/// A closed shell, or one that is open at its foot alone, that holds a point or on which the point lies.
struct ShellAtPoint {
  BodyId body;               ///< 0: the scenery
  std::uint32_t number = 0;  ///< within its body, counted from 1
  bool is_on_it = false;     ///< within the weld tolerance of its surface, as a device that is mounted there

  friend auto operator<=>(const ShellAtPoint&, const ShellAtPoint&) = default;
};

}  // namespace dcem
