#pragma once
/// Maps whose values are means over cells: each cell of a grid is sampled at several points, which are then taken
/// together. A cell is the rectangle spacing_x × spacing_y around its grid point.
///
/// What is averaged, over the samples where a receiver could stand:
///  * powers and path gain in linear units, a sample where nothing arrives counting as 0: P = Σ P_i / n;
///  * mean delay and delay spread weighted by incoherent power: τ = Σ P_i τ_i / Σ P_i. The spread is the mean of those
///    that receivers in the cell have, not that of their profiles put together: the latter would grow with the cell, in
///    free space, too, where no receiver has any;
///  * `line_of_sight` is whether any sample has it; `first_delay_s` is the least one;
///  * `path_count` and `strongest_kinds` are those of the sample with the highest incoherent power, so that they belong
///    together and to a place: a mean of counts is one that may be found nowhere.
/// What maps do not show (K factor, angles, Doppler) is left out. A cell is obstructed where all of its samples are.
#include <span>

#include "dcem/channel/radio_map.hpp"

namespace dcem {

/// The grid of all samples of a grid's cells: sample i of k along an axis lies at (i + 1/2)/k of the cell, so that one
/// sample is the grid point itself. Its own cells have one sample each.
ReceiverGrid sample_grid(const ReceiverGrid& grid);

/// One cell at `position_m` from its samples.
RadioMapPoint cell_average(const Vec3& position_m, std::span<const RadioMapPoint> samples);

/// The map of a grid from that of its `sample_grid`. Throws std::invalid_argument where the points are not as many.
RadioMap cell_averages(const ReceiverGrid& grid, const RadioMap& samples);

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/channel/cell_average_bodies.hpp"
#endif
