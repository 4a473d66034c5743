#pragma once
/// Coverage maps as CSV, as a picture, as arrays and as a raster.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/channel/radio_map.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/heat_map.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {
class ThreadPool;
}

namespace dcem::io {

inline constexpr std::string_view map_csv_header =
    "x_m,y_m,z_m,power_dbm,power_incoherent_dbm,path_gain_db,field_strength_dbuv_per_m,mean_delay_s,rms_delay_spread_s,"
    "line_of_sight,path_count,strongest_kinds";

/// `map_<grid>_<transmitter>[_<frame>]`, without an ending. Characters of the ids that a file name cannot hold stand as
/// % and two hexadecimal digits. `frame` is absent where there is only one.
std::string map_name(const std::string& grid, const std::string& transmitter, std::optional<std::size_t> frame = {});

/// Writes a line per point, row by row or in the order of the list. Of an obstructed point only the coordinates are
/// given; the other fields are empty. The field strength belongs to the coherent power. Throws `OutputError`.
void write_map_csv(AtomicFile& file, const RadioMap& map, double frequency_hz);

/// Writes arrays over [row, column], row 0 that of the smallest y, or over [point]: `x_m`, `y_m`, `z_m` and the columns
/// of the CSV under their names, float64 with NaN where the CSV is empty; `line_of_sight`, `obstructed` and `sheltered`
/// bool, `path_count` uint32, `strongest_kinds` text; and the number `frequency_hz`. Throws `OutputError`.
void write_map_npz(AtomicFile& file, const RadioMap& map, double frequency_hz);

/// Writes the coherent power in dBm as an ESRI ASCII grid (`write_esri_grid`). Precondition, as of the picture: a map
/// over a grid. Throws `OutputError`.
void write_map_asc(AtomicFile& file, const RadioMap& map);

/// The picture of a map: the incoherent power in dBm at each point. It is the mean over a few wavelengths, which is all
/// that points further apart than half a wavelength can show. Obstructed and sheltered points are hatched; walls are
/// where the scene, as it stands now, meets the plane of the grid, windows those that more than a tenth of the power
/// passes upright; every transmitter of the scene has its symbol and its name.
/// `time_s` goes into the title where it is given.
HeatMap map_picture(const RadioMap& map, const Scene& scene, const Frame& frame, double frequency_hz,
                    std::optional<double> time_s = {});

/// Light and shade on what stands higher than a grid, seen from above: matt surfaces, light from the north-west that
/// falls under 45°, no shadows cast. As many tones as 1280 along the longer side. The threads of `pool`, where there is
/// one, share the rows.
Relief map_relief(const ReceiverGrid& grid, const Scene& scene, ThreadPool* pool = nullptr);

/// Where the triangles of the scene meet the horizontal plane at `height_m`: segments x0, y0, x1, y1 in metres. A
/// corner that lies exactly on the plane counts as below it, so the cut is that of a plane a hair higher: each triangle
/// gives one segment or none, the outlines of closed bodies stay closed, and a wall that ends at the plane is not
/// drawn.
std::vector<std::array<double, 4>> walls_at_height_m(const Scene& scene, double height_m);

}  // namespace dcem::io
