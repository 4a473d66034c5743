#pragma once
/// The scenario file (JSON): everything a run needs, read and checked.
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dcem/channel/pdp_mode.hpp"
#include "dcem/channel/thermal_noise.hpp"
#include "dcem/io/exchange_settings.hpp"
#include "dcem/io/geo_anchor.hpp"
#include "dcem/io/picture_format.hpp"
#include "dcem/io/traffic.hpp"
#include "dcem/io/value_range.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem::io {

/// The instants at which frames are solved.
struct TimeSettings {
  double start_s = 0.0;
  double step_s = 0.1;
  std::size_t frames = 1;
  std::vector<double> instants_s{};  ///< of each frame, where they are a trace's own steps; otherwise empty

  /// Instant of a frame.
  double time_s(std::size_t frame) const {
    return instants_s.empty() ? start_s + static_cast<double>(frame) * step_s : instants_s[frame];
  }
};

/// Which files `dcem map` writes of each map.
struct MapOutputs {
  bool csv = true;
  bool npz = true;
  bool asc = true;
  PictureFormats pictures{};  ///< of maps and of the distribution over the points
  bool kml = false;           ///< of grids, with a picture of their cells beside it
};

/// How maps are drawn.
struct MapPictureSettings {
  /// Of the colours of power. Absent: chosen by the first frame with a value, the same for all its maps and all later
  /// ones of the run.
  std::optional<ValueRange> range_dbm{};
  std::optional<double> contours_db{};  ///< lines at its multiples, of powers and SINR; absent: none
  std::size_t finer_cells = 1;          ///< so many along each axis of a cell, interpolated between the points
  bool hillshade = true;                ///< light and shade on what is inside of objects
};

/// How much a page of results may hold, so that a browser opens a day's trace, too.
struct ViewerSettings {
  std::size_t max_rays = 400'000;  ///< over all frames; half as many links and poses, ten times as many map values
  std::size_t max_frames = 2'000;

  friend bool operator==(const ViewerSettings&, const ViewerSettings&) = default;
};

/// Which result files are written.
struct OutputSettings {
  bool paths = false;
  bool links = true;
  bool pdp = false;
  double pdp_bin_s = 1e-9;
  PdpMode pdp_mode = PdpMode::incoherent;
  bool cfr = false;
  double cfr_bandwidth_hz = 100e6;
  std::size_t cfr_points = 256;
  bool doppler = false;
  double doppler_bin_hz = 10.0;
  bool npz = false;
  bool plots = false;
  std::size_t plots_max_links = 20;              ///< so many links have pictures, the first ones
  std::optional<std::size_t> plots_pdp_frame{};  ///< frame of the single power delay profile; default: the middle one
  PictureFormats plots_formats{};                ///< of the pictures of links
  MapOutputs map{};
  MapPictureSettings map_pictures{};
  bool html = false;
  ViewerSettings viewer{};
  std::optional<std::size_t> paths_top{};  ///< of each link so many are listed, the strongest; absent: all
  bool paths_gzip = false;
  ExchangeSettings exchange{};  ///< files for other programs
};

/// What the command line may override. Absent: the scenario file decides.
struct ScenarioOverrides {
  std::optional<std::string> discovery;  ///< "exact" or "sampled"
  std::optional<std::string> cache;      ///< "off", "seed" or "exact"
  std::optional<long long> rays;
  std::optional<long long> seed;
  std::optional<std::string> output;  ///< KEY[,KEY…] in place of the file's `output` keys
  std::optional<double> frequency_hz;
};

/// An entry of `receivers` with a list of points: so many of the scene's receivers, one after the other.
struct PointList {
  std::string id;
  std::size_t first = 0;
  std::size_t count = 0;
};

struct Scenario {
  std::string name;  ///< the file's name without folder and extension
  Scene scene;
  SimulationSettings settings;
  TimeSettings time;
  OutputSettings output;
  std::optional<GeoAnchor> geo{};        ///< absent: a plane without a place on the Earth
  std::optional<NoiseSettings> noise{};  ///< of the receivers; absent: maps know no noise
  std::vector<ReceiverGrid> grids;       ///< not yet among the scene's receivers
  std::vector<PointList> point_lists;    ///< which of the scene's receivers are points of a list
  std::optional<Traffic> traffic;        ///< vehicles of a trace; their frames come from a `FrameSource`
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files{};  ///< everything that was read, the scenario itself first

  /// Instant of a frame.
  double time_s(std::size_t frame) const { return time.time_s(frame); }
};

/// Reads a scenario and everything it names. Throws InputError.
Scenario load_scenario(const std::filesystem::path& file, const ScenarioOverrides& overrides = {});

/// Takes the points of lists out of the scene: for maps they are places and no devices of a frame.
std::vector<ReceiverList> take_point_lists(Scenario& scenario);

}  // namespace dcem::io
