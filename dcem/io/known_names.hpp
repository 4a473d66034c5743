#pragma once
/// Names that somebody wrote beside those that there are: which of them is meant, and what a message says of it.
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace dcem::io {

/// The candidate with the fewest edits (letters inserted, removed or replaced) to `name`; of several the first.
/// Precondition: at least one candidate.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// " (did you mean 'rays'?)", where the nearest is near; otherwise nothing. Precondition: at least one candidate.
std::string name_hint(std::string_view name, const std::vector<std::string>& candidates);

/// What is said of a name that is none of the candidates: the hint, and "; expected one of rays, seed". Of more
/// candidates than `most` the first, and how many there are. Precondition: at least one candidate.
std::string expected_names(std::string_view name, const std::vector<std::string>& candidates, std::size_t most = 1000);

}  // namespace dcem::io
