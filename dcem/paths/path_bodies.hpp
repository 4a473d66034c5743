#pragma once
/// Bodies of path.hpp.
#include <algorithm>
#include <compare>
#include <string>
#include <vector>

#include "dcem/core/build_mode.hpp"
#include "dcem/paths/path.hpp"

namespace dcem {

DCEM_INLINE bool reported_before(const Path& a, const Path& b) {
  if (a.length_m != b.length_m) return a.length_m < b.length_m;
  const std::string kinds_a = kinds(a), kinds_b = kinds(b);
  if (kinds_a != kinds_b) return kinds_a < kinds_b;
  const auto compare = [&](auto&& before) {
    return std::lexicographical_compare_three_way(a.interactions.begin(), a.interactions.end(), b.interactions.begin(),
                                                  b.interactions.end(), before);
  };
  const auto points = compare([](const Interaction& x, const Interaction& y) {
    return lexicographic_less(x.point_m, y.point_m)   ? std::strong_ordering::less
           : lexicographic_less(y.point_m, x.point_m) ? std::strong_ordering::greater
                                                      : std::strong_ordering::equal;
  });
  if (points != 0) return points < 0;
  return compare([](const Interaction& x, const Interaction& y) {
           return x.facet != y.facet ? x.facet <=> y.facet : x.wedge <=> y.wedge;
         }) < 0;
}

DCEM_INLINE void detail::sort_and_drop_repeated(std::vector<Path>& paths) {
  std::sort(paths.begin(), paths.end(), reported_before);
  // The same sequence gives the same bits, so repeated paths stand side by side.
  paths.erase(std::unique(paths.begin(), paths.end(), same_sequence), paths.end());
}

}  // namespace dcem
