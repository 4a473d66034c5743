#pragma once
/// Results of a run as text, frame by frame: `paths.jsonl`, `links.csv` and `pdp.csv`.
///
/// Numbers have the fewest digits that read back as the same double. What is not defined is an empty field in CSV and
/// `null` in JSON, never NaN or infinity. The same results give the same bytes. docs/results.md names every column.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/frame_result.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem::io {

/// The columns of `links.csv`, as its first line has them.
inline constexpr std::string_view links_csv_header =
    "frame,time_s,tx,rx,line_of_sight,path_count,complete,valid_until_m,power_dbm,power_incoherent_dbm,power_los_dbm,"
    "power_reflected_dbm,power_transmitted_dbm,power_diffracted_dbm,power_diffuse_dbm,path_gain_db,first_delay_s,"
    "mean_delay_s,rms_delay_spread_s,k_factor_db,azimuth_spread_arrival_rad,azimuth_spread_departure_rad,"
    "mean_doppler_hz,rms_doppler_spread_hz";

inline constexpr std::string_view pdp_csv_header = "frame,tx,rx,delay_s,power_dbm";

/// Writes the files that `output` asks for into a folder; the caller commits the folder after the last frame.
class ResultWriter {
 public:
  /// `receivers` are those that `LinkResult::receiver` indexes; `discovery` is how paths were found. The folder and the
  /// scene must outlive the writer, and the scene may move between the frames. Throws `OutputError`.
  ResultWriter(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers, Discovery discovery,
               const OutputSettings& output);

  /// Appends a frame. Lines are in the order of the frame's links. Throws `OutputError`.
  void write(const FrameResult& frame);

 private:
  /// A file with the lines that are not yet handed to the operating system.
  struct Sheet {
    AtomicFile* file = nullptr;  // absent: not asked for
    std::string text;

    void flush(std::size_t limit);
  };

  void append_paths(const FrameResult& frame, const LinkResult& link);
  void append_path(const LinkResult& link, const PathContribution& path);
  void append_link(const FrameResult& frame, const LinkResult& link);
  void append_profile(const FrameResult& frame, const LinkResult& link);
  std::string object_json(BodyId id) const;

  const Scene& scene_;
  OutputSettings output_;
  std::string_view found_by_;
  Sheet paths_, links_, profile_;
  // Names as they stand in the files, prepared once: the transmitters', the receivers', bodies' and materials'.
  std::vector<std::string> json_transmitters_, json_receivers_, json_bodies_, json_materials_;
  std::vector<std::string> csv_transmitters_, csv_receivers_;
  std::vector<double> power_dbm_;  // of each transmitter
};

}  // namespace dcem::io
