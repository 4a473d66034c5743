#pragma once
/// The colours of maps: viridis, perceptually even, legible in grey and for colour-blind readers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "dcem/io/image.hpp"

namespace dcem::io {

/// The viridis colour for `share` 0 (lowest, dark violet) … 1 (highest, yellow); values outside are clamped.
///
/// Eighteen control points in equal steps, every fifteenth of the 256 colours of the original table by Stéfan van der
/// Walt and Nathaniel Smith (public domain, CC0: github.com/BIDS/colormap; the `viridis` of Matplotlib), mixed
/// linearly in sRGB between them. No channel is further than 5 of 255 from the original table.
inline Colour viridis(double share) {
  constexpr std::array<Colour, 18> points{{{68, 1, 84},
                                           {72, 23, 105},
                                           {71, 42, 122},
                                           {67, 61, 132},
                                           {61, 78, 138},
                                           {53, 94, 141},
                                           {46, 109, 142},
                                           {41, 123, 142},
                                           {35, 137, 142},
                                           {31, 151, 139},
                                           {33, 165, 133},
                                           {46, 179, 124},
                                           {70, 192, 111},
                                           {101, 203, 94},
                                           {137, 213, 72},
                                           {176, 221, 47},
                                           {216, 226, 25},
                                           {253, 231, 37}}};
  const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(points.size() - 1);
  const std::size_t lower = std::min(static_cast<std::size_t>(position), points.size() - 2);
  return mix(points[lower], points[lower + 1], position - static_cast<double>(lower));
}

/// The colour of thing number `index`: the seven of Okabe and Ito ("Color Universal Design", 2002), which colour-blind
/// readers can tell apart, in an order that keeps the first ones apart in grey; then the same seven lighter, then
/// darker; after 21 they repeat.
inline Colour category_colour(std::size_t index) {
  constexpr std::array<Colour, 7> hues{
      {{230, 159, 0}, {0, 114, 178}, {240, 228, 66}, {213, 94, 0}, {86, 180, 233}, {0, 158, 115}, {204, 121, 167}}};
  const Colour hue = hues[index % hues.size()];
  const std::size_t round = index / hues.size() % 3;
  if (round == 0) return hue;
  return round == 1 ? mix(hue, {255, 255, 255}, 0.55) : mix(hue, {0, 0, 0}, 0.45);
}

}  // namespace dcem::io
