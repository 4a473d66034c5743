#include "dcem/io/src/traffic/trace_survey.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dcem/core/statistics.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/known_names.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

struct TypeCount {
  std::size_t now = 0, most = 0;
};

class Surveyor {
 public:
  Surveyor(const VehicleTypes& types, const SurveyWishes& wishes, TraceSurvey& result)
      : types_(types), wishes_(wishes), result_(result) {
    if (wishes.geo) near_ = place_on_earth(*wishes.geo, 0.0, 0.0);
  }

  void read(const std::filesystem::path& trace) {
    FcdReader reader(trace);
    for (FcdStep step, before; reader.next(step); std::swap(step, before)) {
      count_types(reader.file(), step);
      note_presence(step);
      add_distances(before, step);
      look_for_degrees(step);
      result_.step_times_s.push_back(step.time_s);
    }
    if (near_) {
      result_.traffic.degrees = wishes_.geo;
    } else {
      check_distances(reader.file());
    }
    std::set<std::string> ordered;
    for (const auto& [name, count] : counts_) ordered.insert(name);
    for (const std::string& name : ordered) {
      result_.traffic.types.push_back({name, *types_.find_size_m(name), counts_.at(name).most, 0});
    }
  }

 private:
  void count_types(const std::string& file, const FcdStep& step) {
    for (auto& [name, count] : counts_) count.now = 0;
    for (const FcdVehicle& vehicle : step.vehicles) {
      auto found = counts_.find(vehicle.type);
      if (found == counts_.end()) {
        check_type(file, vehicle);
        found = counts_.emplace(vehicle.type, TypeCount{}).first;
      }
      TypeCount& count = found->second;
      count.most = std::max(count.most, ++count.now);
      if (wishes_.all_types) result_.traffic.types_of_vehicles.emplace(vehicle.id, vehicle.type);
    }
  }

  void check_type(const std::string& file, const FcdVehicle& vehicle) const {
    if (types_.find_size_m(vehicle.type) != nullptr) return;
    throw InputError(file, vehicle.line,
                     "vehicle " + in_quotes(vehicle.id) + ": type: " + in_quotes(vehicle.type) +
                         " is in no file of vehicle_types" + expected_names(vehicle.type, types_.ids(), 20));
  }

  void note_presence(const FcdStep& step) {
    for (const std::string& name : wishes_.names) {
      const auto found =
          std::lower_bound(step.vehicles.begin(), step.vehicles.end(), name,
                           [](const FcdVehicle& vehicle, const std::string& id) { return vehicle.id < id; });
      if (found == step.vehicles.end() || found->id != name) continue;
      std::vector<Traffic::Interval>& intervals = result_.traffic.presence[name];
      const bool goes_on = !intervals.empty() && intervals.back().last_s == result_.step_times_s.back();
      if (!goes_on) intervals.push_back({step.time_s, step.time_s});
      intervals.back().last_s = step.time_s;
    }
  }

  /// How far the vehicles of both steps went, by their positions and by their speeds.
  void add_distances(const FcdStep& before, const FcdStep& step) {
    auto from = before.vehicles.begin();
    for (const FcdVehicle& to : step.vehicles) {
      while (from != before.vehicles.end() && from->id < to.id) ++from;
      if (from == before.vehicles.end()) return;
      if (from->id != to.id) continue;
      moved_m_ += std::hypot(to.x_m - from->x_m, to.y_m - from->y_m);
      driven_m_ += std::abs(to.speed_mps) * (step.time_s - before.time_s);
    }
  }

  void look_for_degrees(const FcdStep& step) {
    const auto is_near = [&](const FcdVehicle& vehicle) {
      return std::abs(std::remainder(vehicle.x_m - near_->lon_deg, 360.0)) <= 1.0 &&
             std::abs(vehicle.y_m - near_->lat_deg) <= 1.0;
    };
    if (near_ && !std::ranges::all_of(step.vehicles, is_near)) near_.reset();
  }

  /// A degree is 100 km: longitudes and latitudes taken for metres would hardly move.
  void check_distances(const std::string& file) const {
    if (driven_m_ < 100.0 || moved_m_ > 1e-3 * driven_m_) return;
    const std::string moved_m = std::to_string(std::llround(moved_m_)),
                      driven_m = std::to_string(std::llround(driven_m_));
    throw InputError(
        file,
        "vehicles move " + moved_m + " m where their speeds say " + driven_m +
            " m; expected x and y in metres; for longitude and latitude the block geo, with the scene within a degree");
  }

  const VehicleTypes& types_;
  const SurveyWishes& wishes_;
  TraceSurvey& result_;
  std::unordered_map<std::string, TypeCount> counts_;
  double moved_m_ = 0.0, driven_m_ = 0.0;
  std::optional<GeoPlace> near_;  ///< the scene, as long as all vehicles are near it by longitude and latitude
};

}  // namespace

TraceSurvey survey_trace(const std::filesystem::path& trace, const VehicleTypes& types, const SurveyWishes& wishes) {
  TraceSurvey survey;
  survey.traffic.trace = trace;
  Surveyor(types, wishes, survey).read(trace);
  survey.traffic.first_s = survey.step_times_s.front();
  survey.traffic.last_s = survey.step_times_s.back();
  return survey;
}

double median_step_s(const std::vector<double>& step_times_s) {
  std::vector<double> differences_s;
  for (std::size_t index = 1; index < step_times_s.size(); ++index) {
    differences_s.push_back(step_times_s[index] - step_times_s[index - 1]);
  }
  if (differences_s.empty()) return 0.0;
  const double median_s = median(differences_s);
  const double rounded_s = std::round(median_s * 1e6) / 1e6;
  return rounded_s > 0.0 && std::abs(rounded_s - median_s) < 1e-9 ? rounded_s : median_s;
}

}  // namespace dcem::io
