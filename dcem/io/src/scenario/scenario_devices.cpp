#include <algorithm>
#include <cmath>
#include <set>

#include "dcem/channel/radio_map.hpp"
#include "dcem/core/units.hpp"
#include "dcem/io/known_names.hpp"
#include "dcem/io/src/scenario/points_csv.hpp"
#include "dcem/io/src/scenario/scenario_parts.hpp"
#include "dcem/io/src/text/text_input.hpp"

namespace dcem::io {

namespace {

/// Points of one grid, samples of its cells among them; a map keeps what is found at each of them until it is done.
constexpr double most_grid_points = 1e8;
/// Numbers in the channel matrix of one path: 16 MB.
constexpr std::size_t most_channel_entries = std::size_t{1} << 20;

double read_power_dbm(const JsonObject& device) {
  if (device.chosen("power") == "power_dbm") return device.at("power_dbm").number();
  return watt_to_dbm(device.at("power_w").number());
}

/// Along x and along y.
std::array<std::size_t, 2> read_counts(const JsonValue& value) {
  const std::vector<JsonValue> counts = value.elements();
  return {static_cast<std::size_t>(counts[0].integer()), static_cast<std::size_t>(counts[1].integer())};
}

void check_point_count(const JsonObject& object, const ReceiverGrid& grid) {
  const double points = static_cast<double>(grid.count[0]) * static_cast<double>(grid.count[1]) *
                        static_cast<double>(grid.samples_per_cell());
  if (points <= most_grid_points) return;
  const double gigabytes = points * static_cast<double>(sizeof(RadioMapPoint)) / 1e9;
  object.at(grid.samples_per_cell() > 1 ? "samples" : "count")
      .fail(std::to_string(std::llround(points)) + " points need " + std::to_string(std::llround(gigabytes)) +
            " GB for each transmitter; expected at most " + std::to_string(std::llround(most_grid_points)) + " points");
}

ReceiverGrid read_grid(const JsonValue& value) {
  const JsonObject object = value.object();
  ReceiverGrid grid;
  grid.origin_m = object.at("origin_m").vector3();
  const std::vector<JsonValue> spacing = object.at("spacing_m").elements();
  grid.spacing_m = {spacing[0].number(), spacing[1].number()};
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(grid.origin_m[axis]) * 1e-12 < grid.spacing_m[static_cast<std::size_t>(axis)]) continue;
    object.at("spacing_m").fail("too small beside the origin; expected at least a millionth of a millionth of it");
  }
  grid.count = read_counts(object.at("count"));
  if (const auto samples = object.find("samples")) grid.samples = read_counts(*samples);
  check_point_count(object, grid);
  const Vec3 last_m = grid_point_m(grid, grid.rows() - 1, grid.columns() - 1);
  if (!(glm::length(last_m) <= 2.0 * farthest_coordinate_m))
    value.fail("reaches too far; expected points within 1e9 m");
  return grid;
}

/// Reads one entry of `transmitters` or `receivers`.
class DeviceReader {
 public:
  DeviceReader(const JsonValue& value, bool transmits, const std::filesystem::path& folder, MotionReader& motions,
               AntennaReader& antennas, Scenario& result)
      : object_(value.object()),
        transmits_(transmits),
        folder_(folder),
        motions_(motions),
        antennas_(antennas),
        result_(result) {}

  void read() {
    device_.id = object_.at("id").identifier();
    device_.antenna = antennas_.read(object_);
    if (transmits_) device_.power_dbm = read_power_dbm(object_);
    const std::string form = object_.chosen("place");
    if (form != "attach_to") refuse({"offset_m", "sees_own_body"}, "attach_to");
    const bool stands = form == "position_m" || form == "positions_m" || form == "points_csv";
    if (!stands) refuse({"velocity_mps"}, "position_m, positions_m or points_csv");
    if (form == "position_m") add_at(device_.id, read_position_m(object_.at("position_m")));
    if (form == "positions_m") add_list(read_positions_m());
    if (form == "points_csv") add_list(read_points_m());
    if (form == "grid") add_grid();
    if (form == "attach_to") add_attached();
    if (form == "motion") add_moving(device_.id, motions_.read(object_.at("motion"), device_.id));
  }

 private:
  void refuse(const std::vector<std::string>& keys, const std::string& owner) const {
    for (const std::string& key : keys) {
      if (object_.has(key)) object_.at(key).fail("goes with " + owner + " only; expected no such key");
    }
  }

  void add_moving(const std::string& id, const Motion& motion) {
    Device device = device_;
    device.id = id;
    device.motion = motion;
    add(std::move(device));
  }

  static Vec3 read_position_m(const JsonValue& position) { return position.vector3(); }

  void add_at(const std::string& id, const Vec3& position_m) {
    add_moving(id, LinearMotion{{position_m}, read_velocity_mps(object_), result_.time.start_s});
  }

  std::vector<Vec3> read_positions_m() const {
    std::vector<Vec3> positions_m;
    for (const JsonValue& position : object_.at("positions_m").elements()) {
      positions_m.push_back(read_position_m(position));
    }
    return positions_m;
  }

  std::vector<Vec3> read_points_m() const {
    return read_points_csv(existing_file(object_.at("points_csv"), folder_, "expected a table of points"));
  }

  void add_list(const std::vector<Vec3>& positions_m) {
    if (!transmits_) {
      result_.point_lists.push_back({device_.id, result_.scene.receivers().size(), positions_m.size()});
    }
    for (std::size_t index = 0; index < positions_m.size(); ++index) {
      add_at(device_.id + "[" + std::to_string(index) + "]", positions_m[index]);
    }
  }

  void add_attached() {
    const JsonValue target = object_.at("attach_to");
    Device device = device_;
    device.attachment =
        Attachment{target.text(), object_.at("offset_m").vector3(), object_.boolean("sees_own_body", false)};
    if (!result_.scene.find_body(target.text())) check_vehicle(target);
    add(std::move(device));
  }

  /// The object that a device rides on must be a vehicle of the trace.
  void check_vehicle(const JsonValue& target) {
    if (!result_.traffic || !result_.traffic->presence.contains(target.text())) fail_unknown_object(target);
    result_.traffic->riders.push_back({target.text(), target.place(), target.path()});
  }

  void fail_unknown_object(const JsonValue& target) const {
    std::vector<std::string> ids;
    for (const Body& body : result_.scene.bodies().subspan(1)) {
      if (!body.is_slot) ids.push_back(body.id);
    }
    const bool traffic = result_.traffic.has_value();
    const std::string none = traffic ? "a vehicle of the trace" : "an entry in objects";
    const std::string nearest =
        ids.empty() ? none : "the nearest known one, " + in_quotes(nearest_name(target.text(), ids));
    target.fail("no object " + std::string(traffic ? "or vehicle " : "") + in_quotes(target.text()) + "; expected " +
                nearest);
  }

  void add_grid() {
    ReceiverGrid grid = read_grid(object_.at("grid"));
    grid.id = device_.id;
    grid.antenna = device_.antenna;
    result_.grids.push_back(std::move(grid));
  }

  void add(Device device) {
    reported_at(object_.value(), [&] {
      transmits_ ? result_.scene.add_transmitter(std::move(device)) : result_.scene.add_receiver(std::move(device));
    });
  }

  JsonObject object_;
  bool transmits_;
  const std::filesystem::path& folder_;
  MotionReader& motions_;
  AntennaReader& antennas_;
  Scenario& result_;
  Device device_;
};

/// One id per entry; those of a list or a grid get their numbers only after that.
void read_list(const JsonValue& list, bool transmits, const std::filesystem::path& folder, MotionReader& motions,
               AntennaReader& antennas, Scenario& result) {
  std::set<std::string> ids;
  for (const JsonValue& element : list.elements()) {
    DeviceReader(element, transmits, folder, motions, antennas, result).read();
    const JsonValue id = element.member("id");
    if (!ids.insert(id.text()).second) id.fail(in_quotes(id.text()) + " is there twice; expected a new id");
  }
}

/// The largest number of ports, elements times polarizations, among devices and grids.
template <typename Devices>
std::size_t most_ports(const Devices& devices) {
  std::size_t most = 0;
  for (const auto& device : devices) {
    most = std::max(most, device.antenna.array.size() * device.antenna.port_count());
  }
  return most;
}

/// Vehicles may be all that there is.
void require_devices(const JsonObject& scenario, const Scenario& result) {
  const auto fail = [&](const char* key) {
    scenario.fail("the key " + in_quotes(key) + " is missing; expected " + key +
                  ", or vehicles that carry devices (mobility.devices)");
  };
  if (result.scene.transmitters().empty()) fail("transmitters");
  if (result.scene.receivers().empty() && result.grids.empty()) fail("receivers");
}

/// A path keeps a number for each pair of ports.
void check_channel_size(const JsonObject& scenario, const Scenario& result) {
  const std::size_t sent = most_ports(result.scene.transmitters());
  const std::size_t heard = std::max(most_ports(result.scene.receivers()), most_ports(result.grids));
  if (sent * heard <= most_channel_entries) return;
  const JsonValue place = scenario.find("receivers").value_or(scenario.value());
  place.fail("arrays with " + std::to_string(heard) + " ports hear arrays with " + std::to_string(sent) +
             "; expected at most " + std::to_string(most_channel_entries) + " pairs of ports");
}

}  // namespace

void read_devices(const JsonObject& scenario, const std::filesystem::path& folder, MotionReader& motions,
                  AntennaReader& antennas, Scenario& result) {
  const auto read = [&](const char* list, bool transmits) {
    if (const auto devices = scenario.find(list)) read_list(*devices, transmits, folder, motions, antennas, result);
  };
  read("transmitters", true);
  read("receivers", false);
  read_vehicle_devices(scenario, antennas, result);
  require_devices(scenario, result);
  check_channel_size(scenario, result);
}

}  // namespace dcem::io
