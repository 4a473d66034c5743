#pragma once
/// What is said of results that rays may have left incomplete. Where nothing is left to rays, nothing is said.
#include <string>
#include <vector>

#include "dcem/sim/search_plan.hpp"
#include "dcem/sim/settings.hpp"
#include "dcem/sim/verify/sampling_check.hpp"

namespace dcem::io {

/// What rays look for, as in "paths of more than 3 interactions".
std::string sampled_kinds(const PropagationSettings& propagation, const SearchPlan& plan);

/// One line: what is sampled, and what is missing on the links that were searched again. Precondition: something is
/// sampled.
std::string sampling_warning(const SamplingReport& report, const std::string& sampled);

/// The same for the foot of a picture, in lines of some 60 characters; none where nothing is sampled.
std::vector<std::string> sampling_notes(const SamplingReport& report);

}  // namespace dcem::io
