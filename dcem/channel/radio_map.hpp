#pragma once
/// A coverage map: what a receiver would measure at each point of a grid or of a list.
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "dcem/channel/link_statistics.hpp"
#include "dcem/core/constants.hpp"
#include "dcem/core/units.hpp"
#include "dcem/scene/device.hpp"

namespace dcem {

struct RadioMapPoint {
  Vec3 position_m{0.0};
  /// Inside a closed object or on a surface: nothing can be measured here, and nothing is reported.
  bool obstructed = false;
  LinkStatistics statistics;
  std::string strongest_kinds;  ///< kinds of the strongest path; empty also for the line of sight
  /// Nothing arrives from any transmitter, and it is indoors: no point of a street without coverage. Whoever makes maps
  /// of the outdoors may say so; nothing else depends on it.
  bool sheltered = false;
};

/// Where the points of a map lie: on a grid, row by row (row 0 has the smallest y), or in a list.
class MapPlaces {
 public:
  MapPlaces(ReceiverGrid grid) : id_(grid.id), places_(std::move(grid)) {}  // NOLINT: a map is one of a grid
  MapPlaces(std::string list, std::size_t size) : id_(std::move(list)), places_(size) {}

  const std::string& id() const { return id_; }
  bool is_grid() const { return places_.index() == 0; }
  /// Precondition: the places are a grid; throws std::bad_variant_access otherwise.
  const ReceiverGrid& grid() const { return std::get<0>(places_); }
  /// Rows and columns, or the length of the list.
  std::vector<std::size_t> shape() const {
    return is_grid() ? std::vector{grid().rows(), grid().columns()} : std::vector{std::get<1>(places_)};
  }
  std::size_t size() const { return is_grid() ? grid().size() : std::get<1>(places_); }

 private:
  std::string id_;
  std::variant<ReceiverGrid, std::size_t> places_;
};

/// The map of one transmitter.
struct RadioMap {
  MapPlaces places;
  std::string transmitter;
  std::vector<RadioMapPoint> points;

  const ReceiverGrid& grid() const { return places.grid(); }  ///< as there
};

/// Field strength (rms) that gives an isotropic receiver of gain 1 this power: E = √(4π·Z0·P)/λ, in dB over 1 µV/m.
/// Source: ITU-R P.525-4, section 2 (P = E²/Z0 · λ²/4π).
inline double field_strength_dbuv_per_m(double power_dbm, double frequency_hz) {
  const double wavelength_m = speed_of_light_mps / frequency_hz;
  const double field_v_per_m = std::sqrt(4.0 * pi * free_space_impedance_ohm * dbm_to_watt(power_dbm)) / wavelength_m;
  return amplitude_ratio_to_db(field_v_per_m * 1e6);
}

}  // namespace dcem
