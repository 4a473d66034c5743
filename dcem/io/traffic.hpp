#pragma once
/// Vehicles of a recorded trace (SUMO's floating car data), as far as they are known without reading it again.
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dcem/geometry/vector.hpp"
#include "dcem/io/geo_anchor.hpp"

namespace dcem::io {

/// What loading a scenario keeps of its trace. The size does not grow with the number of vehicles that pass,
/// unless each of them is to carry a device.
struct Traffic {
  /// Vehicles of one shape, and their slots in the scene: bodies [first_body, first_body + slots).
  struct Type {
    std::string name;
    Vec3 size_m{0.0};       ///< length, width, height
    std::size_t slots = 0;  ///< the largest number of them at a time
    std::size_t first_body = 0;
  };
  /// Instants from a first step to a last one, with all between.
  struct Interval {
    double first_s = 0.0, last_s = 0.0;
  };
  /// A device that rides on a vehicle, and where the scenario says so.
  struct Rider {
    std::string vehicle;
    std::string place;  ///< FILE:LINE
    std::string key;    ///< "receivers[0].attach_to"
  };

  std::filesystem::path trace;
  std::optional<GeoAnchor> degrees{};  ///< its x and y are longitudes and latitudes, and this places them in the scene
  double first_s = 0.0, last_s = 0.0;  ///< of the trace's steps
  std::vector<Type> types;             ///< ascending by name
  /// When the vehicles that the scenario names are there; those that never come are missing.
  std::map<std::string, std::vector<Interval>> presence;
  std::vector<Rider> riders;
  /// Of every vehicle its type, where the scenario puts devices on vehicles; otherwise empty.
  std::map<std::string, std::string> types_of_vehicles{};
};

/// How far an instant may be from a step of the trace to be that step.
inline constexpr double trace_tolerance_s = 1e-6;

}  // namespace dcem::io
