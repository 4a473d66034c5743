#pragma once
/// Where the vehicles of a trace are at an instant. Private to dcem::io.
#include <cstddef>
#include <string>
#include <vector>

#include "dcem/io/src/traffic/fcd_reader.hpp"
#include "dcem/io/traffic.hpp"
#include "dcem/world/motion.hpp"

namespace dcem::io {

/// A vehicle at an instant.
struct DrivingVehicle {
  std::string id;
  std::size_t type = 0;  ///< index in `Traffic::types`
  Placement placement;   ///< of the centre of its footprint
};

/// Where a vehicle of this length is and how it moves: its local origin is half a length behind the front bumper.
Placement vehicle_placement(const FcdVehicle& vehicle, double length_m);

/// Reads a trace forward in time; two steps are in memory. Throws InputError.
class TraceMotion {
 public:
  explicit TraceMotion(const Traffic& traffic);

  /// The vehicles at an instant of the trace's range, ascending by id; instants must not decrease.
  const std::vector<DrivingVehicle>& at(double time_s);

 private:
  /// A step with its vehicles as they stand in the scene.
  struct Step {
    double time_s = 0.0;
    std::vector<DrivingVehicle> vehicles;
    std::vector<double> speeds_mps;
  };

  /// Where the trace has ended: false, and nothing else.
  bool read_step();
  const std::vector<DrivingVehicle>& between_steps(double time_s);
  std::size_t type_index(const FcdVehicle& vehicle) const;
  void interpolate(double time_s);
  [[noreturn]] void fail_changed(std::size_t line) const;

  std::vector<Traffic::Type> types_;
  FcdReader reader_;
  FcdStep raw_;
  Step before_, after_;
  std::size_t steps_ = 0;  ///< read so far; `before_` is one of them from two on
  std::vector<DrivingVehicle> between_;
};

}  // namespace dcem::io
