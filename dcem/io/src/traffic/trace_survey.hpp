#pragma once
/// One reading of a whole trace: its steps, how many vehicles of each type drive at a time, and when those vehicles are
/// there that the scenario names. Private to dcem::io.
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "dcem/io/geo_anchor.hpp"
#include "dcem/io/src/traffic/fcd_reader.hpp"
#include "dcem/io/src/traffic/vehicle_types.hpp"
#include "dcem/io/traffic.hpp"

namespace dcem::io {

/// What the reading found; `traffic.riders` and the bodies in the scene are left to others.
struct TraceSurvey {
  Traffic traffic;
  std::vector<double> step_times_s;  ///< increasing, at least one
};

/// Which vehicles a reading takes note of.
struct SurveyWishes {
  std::set<std::string> names;  ///< when these are there
  bool all_types = false;       ///< of which type each vehicle is
  /// Where the scene lies on the Earth. A trace with all its vehicles within a degree of that, read as longitudes and
  /// latitudes, is taken for one: in metres they would all stand on two metres.
  std::optional<GeoAnchor> geo{};
};

/// Throws InputError: what `FcdReader` throws, and a vehicle whose type is not in `types`.
TraceSurvey survey_trace(const std::filesystem::path& trace, const VehicleTypes& types, const SurveyWishes& wishes);

/// The median of the differences between steps; 0 where there is but one step. A difference within a nanosecond of
/// whole microseconds is taken for these, or the rounding of the trace's decimals would add up over the frames.
double median_step_s(const std::vector<double>& step_times_s);

}  // namespace dcem::io
