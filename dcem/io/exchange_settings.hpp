#pragma once
/// What scenarios say of the files for other programs.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dcem::io {

/// `links.kml`.
struct KmlSettings {
  std::array<double, 2> range_dbm{-120.0, -40.0};  ///< ends of the colours; lines stand on the ground at the lower one
  double metres_per_db = 0.5;                      ///< how high they stand above it
  /// The scenario's second 0 in microseconds since 1970; default: the beginning of the year 2000.
  std::int64_t start_us = 946'684'800'000'000;
};

/// `scene.glb`.
struct GltfSettings {
  std::optional<std::size_t> frame{};  ///< whose rays there are; absent: the first one
  std::size_t max_rays = 20'000;       ///< the strongest ones
  double range_db = 60.0;              ///< what the colours span below the strongest ray
};

/// `paths.h5`.
struct Hdf5Settings {
  std::vector<std::string> columns{};  ///< empty: the usual ones
  bool single = false;                 ///< float32 instead of float64
};

/// Which of these files are written.
struct ExchangeSettings {
  bool mat = false;
  bool qd = false;
  bool kml = false;
  bool gltf = false;
  bool hdf5 = false;
  bool p2m = false;
  bool deepmimo = false;
  KmlSettings kml_settings{};
  GltfSettings gltf_settings{};
  Hdf5Settings hdf5_settings{};
};

}  // namespace dcem::io
