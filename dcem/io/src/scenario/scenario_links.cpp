#include <cmath>
#include <limits>
#include <string>

#include "dcem/core/random.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"

namespace dcem::io {

namespace {

/// A share of all vehicles: which, depends on their ids and on the seed alone.
class VehicleLottery {
 public:
  explicit VehicleLottery(const JsonObject& block)
      : share_(block.at("share").number()), seed_(static_cast<std::uint64_t>(block.integer("seed", 1))) {}

  bool draws(const std::string& id) const {
    const std::uint64_t value = hash_values(seed_, hash_text(id));
    return std::ldexp(static_cast<double>(value >> 11U), -53) < share_;
  }

 private:
  double share_;
  std::uint64_t seed_;
};

/// Adds a device to each vehicle that `mobility.devices` names.
class VehicleDevices {
 public:
  VehicleDevices(const JsonObject& block, AntennaReader& antennas, Scenario& result)
      : block_(block), result_(result), above_roof_m_(block.number("height_above_roof_m", 0.1)) {
    device_.power_dbm = block.at("power_dbm").number();
    device_.antenna = antennas.read(block);
    for (const Traffic::Type& type : result.traffic->types) heights_m_.emplace(type.name, type.size_m.z);
  }

  void add() {
    const JsonValue vehicles = block_.at("vehicles");
    if (vehicles.is_string()) {
      vehicles.word();
      add_if([](const std::string&) { return true; });
    } else if (vehicles.is_object()) {
      const VehicleLottery lottery(vehicles.object());
      add_if([&](const std::string& id) { return lottery.draws(id); });
    } else {
      for (const JsonValue& id : vehicles.elements()) add_named(id);
    }
    if (count_ > 0) return;
    vehicles.fail("chooses none of the " + std::to_string(result_.traffic->types_of_vehicles.size()) +
                  " vehicles of the trace; expected one at least");
  }

 private:
  template <typename Wanted>
  void add_if(const Wanted& wanted) {
    for (const auto& [id, type] : result_.traffic->types_of_vehicles) {
      if (wanted(id)) add_to(block_.value(), id, type);
    }
  }

  void add_named(const JsonValue& id) {
    const auto found = result_.traffic->types_of_vehicles.find(id.text());
    if (found == result_.traffic->types_of_vehicles.end()) {
      id.fail("no vehicle " + in_quotes(id.text()) + " in the trace; expected one of its vehicles");
    }
    result_.traffic->riders.push_back({id.text(), id.place(), id.path()});
    add_to(id, found->first, found->second);
  }

  void add_to(const JsonValue& place, const std::string& id, const std::string& type) {
    Device device = device_;
    device.id = id;
    device.attachment = Attachment{id, Vec3(0.0, 0.0, heights_m_.at(type) + above_roof_m_)};
    reported_at(place, [&] { result_.scene.add_transceiver(std::move(device)); });
    ++count_;
  }

  const JsonObject& block_;
  Scenario& result_;
  double above_roof_m_;
  std::size_t count_ = 0;
  Device device_;
  std::map<std::string, double> heights_m_;  ///< by type
};

std::vector<std::pair<std::string, std::string>> read_pairs(const JsonValue& list, const Scene& scene) {
  const auto check = [](const JsonValue& id, std::span<const Device> devices, const char* kind) {
    const auto is_it = [&](const Device& device) { return device.id == id.text(); };
    if (std::any_of(devices.begin(), devices.end(), is_it)) return;
    id.fail("no " + std::string(kind) + " " + in_quotes(id.text()) + "; expected its id");
  };
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const JsonValue& pair : list.elements()) {
    const std::vector<JsonValue> ends = pair.elements();
    check(ends[0], scene.transmitters(), "transmitter");
    check(ends[1], scene.receivers(), "receiver");
    pairs.emplace_back(ends[0].text(), ends[1].text());
  }
  return pairs;
}

}  // namespace

void read_vehicle_devices(const JsonObject& scenario, AntennaReader& antennas, Scenario& result) {
  const auto mobility = scenario.find("mobility");
  if (!mobility) return;
  const auto devices = mobility->object().find("devices");
  if (!devices) return;
  const JsonObject block = devices->object();
  VehicleDevices(block, antennas, result).add();
}

LinkSettings read_links(const JsonObject& scenario, const Scene& scene) {
  LinkSettings settings;
  const auto value = scenario.find("links");
  if (!value) return settings;
  if (value->is_string()) {
    value->word();
    return settings;
  }
  const JsonObject block = value->object();
  if (const auto range = block.find("range_m")) settings.range_m = range->number();
  if (const auto pairs = block.find("pairs")) settings.pairs = read_pairs(*pairs, scene);
  if (!settings.range_m && !settings.pairs) block.fail("says nothing; expected range_m, pairs or both");
  return settings;
}

}  // namespace dcem::io
