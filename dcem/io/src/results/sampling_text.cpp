#include "dcem/io/sampling_text.hpp"

#include "dcem/io/text_table.hpp"
#include "dcem/sim/discovery.hpp"

namespace dcem::io {
namespace {

constexpr double common_share = 0.95;

std::string percent(double share) {
  return format_fixed(100.0 * share, share < 0.995 ? 0 : 1) + " %";
}

std::string decibels(double value_db) {
  return format_fixed(value_db, value_db < 0.095 ? 2 : 1) + " dB";
}

std::string reference(const SamplingReport& report) {
  return report.exact ? "exactly" : "with " + std::to_string(report.reference_rays) + " rays";
}

}  // namespace

std::string sampled_kinds(const PropagationSettings& propagation, const SearchPlan& plan) {
  const int exact = exactly_searched_interactions(propagation, plan);
  if (exact == 0) return "all paths but the direct one";
  const bool two_edges = propagation.max_diffractions > 1 && exact > 2;
  return "paths of more than " + std::to_string(exact) + " interactions" +
         (two_edges ? ", and shorter ones with two diffractions and a reflection," : "");
}

std::string sampling_warning(const SamplingReport& report, const std::string& sampled) {
  const std::string looked_for = "sampled: " + sampled + " are looked for by " + std::to_string(report.rays) + " rays";
  if (report.is_too_long) return looked_for + "; what they lack is not known: a second search would take too long";
  const std::string again = report.exact ? "exactly" : "with " + std::to_string(report.reference_rays);
  std::string text = looked_for + ", which found " + percent(report.recall()) + " of the paths of " +
                     std::to_string(report.links.size()) + " links that were searched again " + again +
                     "; their powers lack " + decibels(report.missing_db(0.5)) + " in the median, " +
                     decibels(report.missing_db(common_share)) + " at 95 %";
  const std::size_t empty = report.links_not_reached();
  if (empty > 0) text += "; on " + std::to_string(empty) + " of them no path was found though there is one";
  return text;
}

std::vector<std::string> sampling_notes(const SamplingReport& report) {
  if (report.is_too_long) {
    return {"sampled: " + std::to_string(report.rays) + " rays; what they lack is not known",
            "(a second search would take too long)"};
  }
  if (report.links.empty()) return {};
  return {"sampled: " + std::to_string(report.rays) + " rays find " + percent(report.recall()) + " of the paths;",
          "powers lack " + decibels(report.missing_db(0.5)) + " in the median, " +
              decibels(report.missing_db(common_share)) + " at 95 %",
          "(" + std::to_string(report.links.size()) + " links searched again " + reference(report) + ")"};
}

}  // namespace dcem::io
