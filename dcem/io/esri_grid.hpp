#pragma once
/// Rasters as text for geographic information systems: the ASCII grid of ESRI (ArcInfo), read by QGIS, GDAL, GRASS.
#include <span>

#include "dcem/io/atomic_file.hpp"
#include "dcem/scene/device.hpp"

namespace dcem::io {

/// Stands for "no value" in the file.
inline constexpr double esri_no_value = -9999.0;

/// Writes one value per grid point, given row by row from the smallest y; in the file the northernmost row comes first.
/// Values that are not finite become -9999. `xllcenter` and `yllcenter` are the grid's origin, in metres. The format
/// has one `cellsize`; where the two spacings differ the header has `dx` and `dy` in its place, which GDAL (and with it
/// QGIS) reads. Throws `OutputError`, and std::invalid_argument where there is not one value per point.
void write_esri_grid(AtomicFile& file, const ReceiverGrid& grid, std::span<const double> values);

}  // namespace dcem::io
