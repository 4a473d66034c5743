#pragma once
/// SUMO's floating car data (the output of `sumo --fcd-output`), one time step after the other. Private to dcem::io.
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/geo_anchor.hpp"
#include "dcem/io/src/traffic/xml_reader.hpp"

namespace dcem::io {

/// A vehicle in a time step, in SUMO's terms.
struct FcdVehicle {
  std::string id, type;
  double x_m = 0.0, y_m = 0.0, z_m = 0.0;  ///< centre of the front bumper; z is 0 where the file has none
  double angle_deg = 0.0;                  ///< clockwise from north, the y axis
  double speed_mps = 0.0;
  double slope_deg = 0.0;  ///< uphill positive; 0 where the file has none
  std::size_t line = 0;
};

struct FcdStep {
  double time_s = 0.0;
  std::size_t line = 0;
  std::vector<FcdVehicle> vehicles;  ///< ascending by id, each id once
};

/// Reads a trace, plain or .gz; only one step is in memory. All functions throw InputError with the line.
///
/// Elements other than `timestep` and `vehicle` (persons, containers) are passed over.
class FcdReader : private XmlHandler {
 public:
  /// `degrees`: x and y are longitude and latitude, and this says where they are in the scene. Angles are SUMO's own in
  /// any case, from the network's y axis.
  explicit FcdReader(const std::filesystem::path& file, std::size_t chunk_bytes = xml_chunk_bytes,
                     std::optional<GeoAnchor> degrees = std::nullopt);

  /// Reads the next step into `step`, whose memory is used again; false at the end of the trace.
  bool next(FcdStep& step);
  const std::string& file() const { return file_; }

 private:
  void start_element(std::string_view name, const XmlAttributes& attributes) override;
  void end_element(std::string_view name) override;

  void start_step(const XmlAttributes& attributes);
  void start_vehicle(const XmlAttributes& attributes);
  void put_into_scene(FcdVehicle& vehicle) const;
  void finish_step();
  FcdVehicle& append_vehicle();
  void read_name(const XmlAttributes& attributes, const char* attribute, std::string& name) const;
  /// A number within ±limit; `absent` where the attribute is missing, an error where there is no such value.
  double number(const XmlAttributes& attributes, const char* attribute, double limit,
                std::optional<double> absent = std::nullopt) const;
  [[noreturn]] void fail_attribute(const char* attribute, const std::string& what) const;

  std::string file_;
  XmlReader reader_;
  std::optional<GeoAnchor> degrees_;
  FcdStep* step_ = nullptr;
  std::size_t vehicle_count_ = 0;  ///< of the step so far
  std::size_t depth_ = 0;
  bool in_step_ = false;
  const char* element_ = "timestep";  ///< what messages speak of
  std::string vehicle_;               ///< the one messages speak of
  std::optional<double> last_time_s_;
};

}  // namespace dcem::io
