#pragma once
/// Antenna patterns of the caller's own, with their polarization.
#include <concepts>
#include <memory>
#include <utility>

#include "dcem/em/antenna/polarization.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// The field of one element. Called from several threads at once; the same question must get the same answer.
class UserPatternModel {
 public:
  virtual ~UserPatternModel() = default;

  /// The field of a port towards a unit direction, both in the antenna's own axes: √gain times a unit Jones vector, in
  /// (θ̂, φ̂). `port` is 0, and also 1 where the antenna's polarization is `dual`; else the polarization is not asked.
  virtual JonesVector field(const Vec3& direction, std::size_t port) const = 0;
  /// No power gain (linear), |field|², is larger; finite.
  virtual double peak_power_gain() const = 0;
};

/// One of the patterns of an antenna.
struct UserPattern {
  std::shared_ptr<const UserPatternModel> model;  ///< never empty in an antenna that `validate` has passed

  friend bool operator==(const UserPattern&, const UserPattern&) = default;
};

/// A pattern made of an object of a class derived from `UserPatternModel`.
template <std::derived_from<UserPatternModel> Model>
UserPattern user_pattern(Model model) {
  return {std::make_shared<const Model>(std::move(model))};
}

}  // namespace dcem
