#pragma once
/// The cells of a map as pixels: colours, textures, hatching. Private to dcem::io.
#include "dcem/io/heat_map.hpp"

namespace dcem::io::detail {

/// Lighter than any value, in grey as well.
inline constexpr Colour no_value_ground{243, 243, 243};
inline constexpr Colour hatch_ground{245, 245, 245}, hatch_line{105, 105, 105};
/// A roof in the shade, and one in full light.
inline constexpr Colour relief_shade{150, 150, 150}, relief_light{255, 255, 255};

/// Lines under 45° over a ground. They run on from one hatched cell to the next.
Colour hatched_colour(Colour ground, double x_px, double y_px);

/// A category's colour, and the texture that tells it apart in grey.
Colour category_pixel(std::size_t category, double x_px, double y_px);

/// 0 at the lower end of the range, 1 at its upper one; beyond it outside.
double share_of_range(double value, const ValueRange& range);

/// All cells, as large as the plot.
Image cells_image(const HeatMap& map, const HeatMapLayout& layout);

}  // namespace dcem::io::detail
