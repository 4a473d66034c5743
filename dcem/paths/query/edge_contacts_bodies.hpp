#pragma once
/// Bodies of edge_contacts.hpp.
#include <algorithm>
#include <functional>
#include <optional>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/query/edge_contacts.hpp"

namespace dcem::detail {

DCEM_INLINE std::optional<double> TriangleBeside::near_place(double inner_m, double outer_m) const {
  for (const double end_m : {0.0, length_m_}) {
    if (distance_m(end_m) <= inner_m) return end_m;
  }
  double low_m = 0.0, high_m = length_m_;
  while (high_m - low_m > least_width * length_m_) {
    const double third_m = (high_m - low_m) / 3.0, one_m = low_m + third_m, other_m = high_m - third_m;
    const double at_one_m = distance_m(one_m), at_other_m = distance_m(other_m);
    if (std::min(at_one_m, at_other_m) <= inner_m) return at_one_m <= at_other_m ? one_m : other_m;
    (at_one_m < at_other_m ? high_m : low_m) = at_one_m < at_other_m ? other_m : one_m;
    if (std::min(at_one_m, at_other_m) - (high_m - low_m) > outer_m) return std::nullopt;
  }
  return 0.5 * (low_m + high_m);
}

DCEM_INLINE Stretch TriangleBeside::within(double place_m, double radius_m) const {
  return {rim(place_m, 0.0, radius_m).inside_m, rim(place_m, length_m_, radius_m).inside_m};
}

DCEM_INLINE Stretch TriangleBeside::around(double place_m, double radius_m) const {
  const double slack_m = least_width * length_m_;
  return {rim(place_m, 0.0, radius_m).outside_m - slack_m, rim(place_m, length_m_, radius_m).outside_m + slack_m};
}

DCEM_INLINE TriangleBeside::Rim TriangleBeside::rim(double place_m, double end_m, double radius_m) const {
  if (distance_m(end_m) <= radius_m) return {end_m, end_m};
  Rim rim{place_m, end_m};
  const double beside_m = end_m > place_m ? std::min(place_m + least_m, end_m) : std::max(place_m - least_m, end_m);
  if (distance_m(beside_m) > radius_m) return {place_m, beside_m};
  for (int step = 0; step < most_halvings; ++step) {
    const double middle_m = 0.5 * (rim.inside_m + rim.outside_m);
    (distance_m(middle_m) <= radius_m ? rim.inside_m : rim.outside_m) = middle_m;
  }
  return rim;
}

DCEM_INLINE EdgeContact contact_of(double length_m, std::vector<Stretch>& touched, std::vector<Stretch>& near) {
  const double guard_m = 1e-6 * (1.0 + length_m);  // more than single precision takes off
  EdgeContact contact;
  double to_m = 0.0, from_m = length_m;
  std::ranges::sort(touched, {}, &Stretch::from_m);
  for (const Stretch& one : touched) {
    if (one.from_m <= to_m) to_m = std::max(to_m, one.to_m);
  }
  if (to_m >= length_m) return all_along_touched();
  std::ranges::sort(touched, std::greater{}, &Stretch::to_m);
  for (const Stretch& one : touched) {
    if (one.to_m >= from_m) from_m = std::min(from_m, one.from_m);
  }
  if (to_m > 0.0) contact.touched_to_m = static_cast<float>(to_m - guard_m);
  if (from_m < length_m) contact.touched_from_m = static_cast<float>(from_m + guard_m);
  std::ranges::sort(near, {}, &Stretch::from_m);
  near.push_back({length_m + guard_m, length_m + guard_m});
  double free_from_m = -guard_m, widest_m = 0.0;
  for (const Stretch& one : near) {
    if (one.from_m - free_from_m > widest_m) {
      widest_m = one.from_m - free_from_m;
      contact.free_from_m = static_cast<float>(free_from_m + guard_m);
      contact.free_to_m = static_cast<float>(one.from_m - guard_m);
    }
    free_from_m = std::max(free_from_m, one.to_m);
  }
  return contact;
}

}  // namespace dcem::detail
