#pragma once
/// What an oracle demands of a link against what a search reports.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "dcem/paths/path.hpp"
#include "dcem/sim/simulator.hpp"
#include "tests/paths/halves/city_oracle.hpp"

namespace dcem::test {

/// Two programs agree on the length of a path to this, metres: their roundings at a kilometre are a thousandth of it.
inline constexpr double same_length_m = 1e-6;

struct FoundPath {
  std::vector<Step> steps;  ///< from the transmitter
  std::vector<Vec3> points_m;
  double length_m = 0.0;
};

inline FoundPath found_path(const Path& path) {
  FoundPath found{{}, {}, path.length_m};
  for (const Interaction& touch : path.interactions) {
    const bool is_edge = touch.kind == InteractionKind::diffraction;
    found.steps.push_back({is_edge, is_edge ? touch.wedge.value : touch.facet.value});
    found.points_m.push_back(touch.point_m);
  }
  return found;
}

inline std::vector<FoundPath> found_paths(const LinkResult& link) {
  std::vector<FoundPath> found;
  for (const PathContribution& path : link.paths) found.push_back(found_path(path.path));
  return found;
}

inline std::string kinds_of(const std::vector<Step>& steps) {
  std::string letters;
  for (const Step& step : steps) letters += step.is_edge ? 'D' : 'R';
  return letters.empty() ? "LOS" : letters;
}

inline std::string described(const std::vector<Step>& steps, const std::vector<Vec3>& points_m) {
  std::ostringstream text;
  text.precision(17);
  text << kinds_of(steps);
  for (std::size_t index = 0; index < steps.size(); ++index) {
    const Vec3& point_m = points_m[index];
    text << "; " << (steps[index].is_edge ? "edge " : "facet ") << steps[index].number << " at (" << point_m.x << ", "
         << point_m.y << ", " << point_m.z << ")";
  }
  return text.str();
}

/// Numbers of required and possible paths by kind, and one line for each that is missing or not possible.
struct Comparison {
  std::map<std::string, std::array<std::size_t, 3>> by_kind;  ///< required, only possible, found
  std::size_t required = 0, overlaid = 0, only_possible = 0, found = 0;
  std::map<std::string, std::size_t> doubts;
  std::vector<std::string> mistakes;

  std::string summary() const {
    std::ostringstream text;
    text << required << " required, " << overlaid << " of them over facets on others, " << only_possible
         << " only possible, " << found << " found; required/possible/found:";
    for (const auto& [kind, numbers] : by_kind) {
      text << ' ' << kind << ' ' << numbers[0] << '/' << numbers[1] << '/' << numbers[2];
    }
    for (const auto& [doubt, number] : doubts) text << "; doubt:" << doubt << ' ' << number;
    return text.str();
  }
};

/// Whether a path is the judged one, but for mirrors for which others that lie on them stand. (Such a path's points may
/// be centimetres away: patches within the weld tolerance of each other are tilted by their dirt.)
inline bool stands_for(const FoundPath& found, const JudgedPath& judged) {
  if (found.steps.size() != judged.steps.size()) return false;
  for (std::size_t index = 0; index < found.steps.size(); ++index) {
    const Step &step = found.steps[index], &wanted = judged.steps[index];
    const auto& others = judged.overlays[index];
    const bool lies_on =
        !step.is_edge && !wanted.is_edge && std::find(others.begin(), others.end(), step.number) != others.end();
    if (step != wanted && !lies_on) return false;
  }
  return true;
}

inline Comparison compared(const std::vector<JudgedPath>& judged, const std::vector<FoundPath>& found) {
  Comparison comparison;
  std::map<std::vector<Step>, const FoundPath*> there;
  for (const FoundPath& path : found) {
    there[path.steps] = &path;
    ++comparison.by_kind[kinds_of(path.steps)][2];
  }
  comparison.found = found.size();
  std::map<std::vector<Step>, const JudgedPath*> known;
  for (const JudgedPath& path : judged) {
    known[path.steps] = &path;
    const bool required = path.verdict == Verdict::required;
    ++comparison.by_kind[kinds_of(path.steps)][required ? 0 : 1];
    ++(required ? comparison.required : comparison.only_possible);
    if (!required) {
      ++comparison.doubts[path.doubts];
      continue;
    }
    comparison.overlaid += path.is_overlaid() ? 1U : 0U;
    const bool there_is = there.contains(path.steps) || std::any_of(found.begin(), found.end(), [&](const auto& other) {
                            return stands_for(other, path);
                          });
    if (!there_is) comparison.mistakes.push_back("missing: " + described(path.steps, path.points_m));
  }
  for (const FoundPath& path : found) {
    const auto place = known.find(path.steps);
    if (place == known.end()) {
      comparison.mistakes.push_back("impossible: " + described(path.steps, path.points_m));
    } else if (std::abs(place->second->length_m - path.length_m) > same_length_m) {
      comparison.mistakes.push_back("length: " + described(path.steps, path.points_m));
    }
  }
  return comparison;
}

}  // namespace dcem::test
