#pragma once
/// How much work an exhaustive search is, before it begins: some orders cannot end, and are better refused.
///
/// The number of sequences of mirrors is estimated by random descents into the tree that `ExactSearch` walks: a descent
/// takes one of the b facets that the beam meets at each step, and the product of all b up to a depth is, in the mean,
/// the number of sequences of that length. Source: D. E. Knuth, "Estimating the efficiency of backtrack programs",
/// Mathematics of Computation 29 (1975) 121–136, section 2. Chains with edges are counted from the mirrors before their
/// first and behind their last edge, and from all that may stand between. Estimates are the same on every machine.
#include <span>
#include <string>

#include "dcem/scene/scene.hpp"
#include "dcem/sim/settings.hpp"

namespace dcem {

/// What one thread tries in a second: 0.6 to 1.2 million where there are many, with edges and without, in a box, a
/// street and an office of 6 to 101 facets.
inline constexpr double sequences_tried_per_s = 1e6;

/// The most sequences that a link may take: a day of one thread.
inline constexpr double most_sequences_of_a_link = 86'400.0 * sequences_tried_per_s;

/// About how many sequences an exhaustive search tries for one link, from the transmitters of the scene as it stands.
/// Without any, and where even that is not much, all sequences there are, met by a beam or not.
double estimated_sequences(const PropagationSettings& propagation, const Scene& scene);

/// Whether an exhaustive search ends: whether a link takes no more than `most_sequences_of_a_link`.
bool search_ends(const PropagationSettings& propagation, const Scene& scene);

/// "37", "1.5e+12".
std::string rough_number(double value);

/// "3 days", "2e+09 years".
std::string rough_duration(double duration_s);

namespace detail {

/// All sequences there are.
double count_all_sequences(const PropagationSettings& propagation, const Scene& scene);
/// Those that beams from some points meet, in the mean. Precondition: there is a point.
double probed_sequences(const PropagationSettings& propagation, const Scene& scene, std::span<const Vec3> points_m);

}  // namespace detail

}  // namespace dcem

#if !defined(DCEM_ENGINE)
#include "dcem/sim/search_size_bodies.hpp"
#endif
