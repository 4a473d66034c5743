#include "dcem/io/src/traffic/fcd_reader.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "dcem/io/input_error.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

constexpr const char* fcd_expectation = "expected SUMO's FCD output in XML";
constexpr double largest_angle_deg = 1e6, latest_s = 1e9;

}  // namespace

FcdReader::FcdReader(const std::filesystem::path& file, std::size_t chunk_bytes, std::optional<GeoAnchor> degrees)
    : file_(file.string()), reader_(file, fcd_expectation, *this, chunk_bytes), degrees_(degrees) {}

bool FcdReader::next(FcdStep& step) {
  step_ = &step;
  if (reader_.read_on()) return true;
  if (!last_time_s_) throw InputError(file_, "holds no timestep; expected at least one");
  return false;
}

void FcdReader::start_element(std::string_view name, const XmlAttributes& attributes) {
  ++depth_;
  if (depth_ == 1 && name != "fcd-export") {
    reader_.fail("the root element is " + in_quotes(name) + "; expected fcd-export, SUMO's FCD output");
  }
  if (name == "timestep") {
    if (depth_ != 2) reader_.fail("a timestep in another element; expected it right in fcd-export");
    start_step(attributes);
  } else if (name == "vehicle") {
    if (!in_step_ || depth_ != 3) reader_.fail("a vehicle outside a timestep; expected it right in a timestep");
    start_vehicle(attributes);
  }
}

void FcdReader::end_element(std::string_view name) {
  --depth_;
  if (name != "timestep") return;
  in_step_ = false;
  finish_step();
  reader_.pause();
}

void FcdReader::start_step(const XmlAttributes& attributes) {
  element_ = "timestep";
  vehicle_.clear();
  step_->line = reader_.line();
  step_->time_s = number(attributes, "time", latest_s);
  if (last_time_s_ && !(step_->time_s > *last_time_s_)) {
    fail_attribute("time", "not later than the step before; expected increasing times");
  }
  last_time_s_ = step_->time_s;
  vehicle_count_ = 0;
  in_step_ = true;
}

FcdVehicle& FcdReader::append_vehicle() {
  if (vehicle_count_ == step_->vehicles.size()) step_->vehicles.emplace_back();
  return step_->vehicles[vehicle_count_++];
}

void FcdReader::start_vehicle(const XmlAttributes& attributes) {
  element_ = "vehicle";
  vehicle_.clear();
  FcdVehicle& vehicle = append_vehicle();
  vehicle.line = reader_.line();
  read_name(attributes, "id", vehicle.id);
  vehicle_ = vehicle.id;
  read_name(attributes, "type", vehicle.type);
  vehicle.x_m = number(attributes, "x", farthest_coordinate_m);
  vehicle.y_m = number(attributes, "y", farthest_coordinate_m);
  vehicle.z_m = number(attributes, "z", farthest_coordinate_m, 0.0);
  vehicle.angle_deg = number(attributes, "angle", largest_angle_deg);
  vehicle.speed_mps = number(attributes, "speed", speed_of_light_mps);
  vehicle.slope_deg = number(attributes, "slope", largest_angle_deg, 0.0);
  if (degrees_) put_into_scene(vehicle);
}

void FcdReader::put_into_scene(FcdVehicle& vehicle) const {
  try {
    const auto [x_m, y_m] = point_in_scene_m(*degrees_, vehicle.y_m, vehicle.x_m);
    vehicle.x_m = x_m;
    vehicle.y_m = y_m;
  } catch (const std::invalid_argument& error) {
    reader_.fail("vehicle " + in_quotes(vehicle_) + ": " + error.what());
  }
}

void FcdReader::finish_step() {
  std::vector<FcdVehicle>& vehicles = step_->vehicles;
  vehicles.resize(vehicle_count_);
  const auto before = [](const FcdVehicle& a, const FcdVehicle& b) {
    const int order = a.id.compare(b.id);
    return order != 0 ? order < 0 : a.line < b.line;
  };
  std::sort(vehicles.begin(), vehicles.end(), before);
  const auto twice = std::adjacent_find(vehicles.begin(), vehicles.end(),
                                        [](const FcdVehicle& a, const FcdVehicle& b) { return a.id == b.id; });
  if (twice == vehicles.end()) return;
  throw InputError(file_, (twice + 1)->line,
                   "vehicle " + in_quotes(twice->id) + " is there twice in a timestep; expected it once");
}

void FcdReader::read_name(const XmlAttributes& attributes, const char* attribute, std::string& name) const {
  const std::optional<std::string_view> text = attributes.find(attribute);
  if (!text) fail_attribute(attribute, "missing; expected it in each vehicle");
  const bool good = !text->empty() && is_printable(*text) && text->find('/') == std::string_view::npos;
  // Types never reach a result; their names may hold slashes.
  const bool good_type = std::string_view(attribute) == "type" && !text->empty() && is_printable(*text);
  if (!good && !good_type) {
    fail_attribute(attribute, "found " + in_quotes(*text) + "; expected a name without slashes and control characters");
  }
  name = *text;
}

double FcdReader::number(const XmlAttributes& attributes, const char* attribute, double limit,
                         std::optional<double> absent) const {
  const std::optional<std::string_view> text = attributes.find(attribute);
  if (!text && absent) return *absent;
  if (!text) fail_attribute(attribute, std::string("missing; expected it in each ") + element_);
  const std::optional<double> value = parse_number(*text);
  if (!value || !(std::abs(*value) <= limit)) {
    fail_attribute(attribute, "found " + in_quotes(*text) + "; expected " + NumberRange{-limit, limit}.text());
  }
  return *value;
}

void FcdReader::fail_attribute(const char* attribute, const std::string& what) const {
  const std::string owner = vehicle_.empty() ? element_ : std::string(element_) + " " + in_quotes(vehicle_);
  reader_.fail(owner + ": " + attribute + ": " + what);
}

}  // namespace dcem::io
