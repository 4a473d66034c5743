#pragma once
/// Maps over all transmitters, best server and SINR, as CSV, pictures, arrays and rasters.
#include <optional>
#include <string_view>

#include "dcem/channel/map_combination.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/heat_map.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem::io {

inline constexpr std::string_view best_server_csv_header = "x_m,y_m,z_m,tx,power_dbm,power_incoherent_dbm";
inline constexpr std::string_view sinr_csv_header = "x_m,y_m,z_m,tx,sinr_db,snr_db";

/// Whether any two transmitters, or one and the noise, can be weighed against each other: otherwise a SINR map is
/// empty.
inline bool has_sinr(const CombinedMap& map, bool has_noise) {
  return has_noise || map.transmitters.size() > 1;
}

// Each throws `OutputError`. Rows are points, row by row or in the order of the list; where nothing arrives the fields
// behind the coordinates are empty.

void write_best_server_csv(AtomicFile& file, const CombinedMap& map);
void write_sinr_csv(AtomicFile& file, const CombinedMap& map);

/// Arrays over [row, column] or [point]: coordinates, `tx` uint32 (the number of the server in `tx_id`, 0 also where
/// `served` is false), `served`, `obstructed` and `sheltered` bool, the columns of the CSV as float64 with NaN where
/// they are empty; `tx_id` text, the transmitters in order.
void write_best_server_npz(AtomicFile& file, const CombinedMap& map);
void write_sinr_npz(AtomicFile& file, const CombinedMap& map);

/// ESRI ASCII grids, of maps over a grid, as are the pictures: the server's number in the order of the scenario,
/// counted from 0; and the SINR in dB.
void write_best_server_asc(AtomicFile& file, const CombinedMap& map);
void write_sinr_asc(AtomicFile& file, const CombinedMap& map);

/// Pictures. The best server has a colour for each transmitter; colours of the SINR go from −10 to 30 dB, so that maps
/// can be compared. `time_s` goes into the title
/// where it is given. `has_noise` is for the names alone: SINR, or SIR.
HeatMap best_server_picture(const CombinedMap& map, const Scene& scene, const Frame& frame, double frequency_hz,
                            std::optional<double> time_s = {});
HeatMap sinr_picture(const CombinedMap& map, const Scene& scene, const Frame& frame, double frequency_hz,
                     bool has_noise, std::optional<double> time_s = {});

}  // namespace dcem::io
