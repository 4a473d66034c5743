#pragma once
/// The lines of `links.csv`.
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/scene/scene.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem {

class ThreadPool;

}  // namespace dcem

namespace dcem::io {

/// The columns, as the first line of the file has them.
inline constexpr std::string_view links_csv_header =
    "frame,time_s,tx,rx,line_of_sight,path_count,complete,valid_until_m,power_dbm,power_incoherent_dbm,power_los_dbm,"
    "power_reflected_dbm,power_transmitted_dbm,power_diffracted_dbm,power_diffuse_dbm,path_gain_db,first_delay_s,"
    "mean_delay_s,rms_delay_spread_s,k_factor_db,azimuth_spread_arrival_rad,azimuth_spread_departure_rad,"
    "mean_doppler_hz,rms_doppler_spread_hz,zenith_spread_arrival_rad,zenith_spread_departure_rad,"
    "coherence_bandwidth_hz,coherence_time_s";

/// Lines of many links, in pieces; shared by all that write them.
using LinePieces = std::shared_ptr<const std::vector<std::string>>;

/// Numbers have the fewest digits that read back as the same double; what is not defined is an empty field.
class LinkLines {
 public:
  /// `receivers` are those that `LinkResult::receiver` indexes.
  LinkLines(const Scene& scene, std::span<const Device> receivers);

  /// Appends the line of a link, with its end of line.
  void append(std::string& text, const FrameResult& frame, const LinkResult& link) const;
  /// The lines of all links of a frame, made by the threads of a pool.
  [[nodiscard]] LinePieces pieces(const FrameResult& frame, ThreadPool& pool) const;

  /// Names as they stand in tables of this kind.
  const std::string& transmitter(const LinkResult& link) const { return transmitters_[link.transmitter]; }
  const std::string& receiver(const LinkResult& link) const { return receivers_[link.receiver]; }

 private:
  /// `begun`: what all lines of the frame begin with.
  void append(std::string& text, std::string_view begun, const LinkResult& link) const;

  std::vector<std::string> transmitters_, receivers_;
};

}  // namespace dcem::io
