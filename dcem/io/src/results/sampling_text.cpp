#include "dcem/io/sampling_text.hpp"

#include <optional>

#include "dcem/io/text_table.hpp"
#include "dcem/sim/discovery.hpp"

namespace dcem::io {
namespace {

constexpr double common_share = 0.95;
constexpr std::size_t least_for_a_quantile = 20;  // of fewer links the worst is said

std::string percent(double share) {
  return format_fixed(100.0 * share, share < 0.995 ? 0 : 1) + " %";
}

std::string decibels(double value_db) {
  return format_fixed(value_db, value_db < 0.095 ? 2 : 1) + " dB";
}

std::string counted(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string again(const SamplingReport& report) {
  return report.exact ? "exactly" : "with " + std::to_string(report.reference_rays) + " rays";
}

/// "0.2 dB in the median, 15.5 dB on the worst link"; empty where no link has a value.
std::string missing(const SamplingReport& report) {
  const std::optional<double> median_db = report.missing_db(0.5);
  if (!median_db) return "";
  const bool is_quantile = report.links.size() >= least_for_a_quantile;
  const double high_db = *report.missing_db(is_quantile ? common_share : 1.0);
  return decibels(*median_db) + " in the median, " + decibels(high_db) +
         (is_quantile ? " at 95 %" : " on the worst link");
}

std::string rays_text(const SamplingReport& report) {
  const std::string rays = counted(report.rays, "ray");
  if (report.rays_steady == 0) return rays;
  return rays + " (" + std::to_string(report.rays_steady) + " and what is remembered from the second frame on)";
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
  std::string text = "sampled: " + sampled + " are looked for by " + rays_text(report);
  if (report.links.empty()) return text + "; what they lack was not checked";
  const std::string searched = counted(report.links.size(), "link") + " searched again " + again(report);
  const std::optional<double> recall = report.recall();
  if (!recall) return text + "; on " + searched + " no path was found either";
  text += ", which found " + percent(*recall) + " of the paths of " + searched;
  if (const std::string lack = missing(report); !lack.empty()) text += "; powers lack " + lack;
  const std::size_t empty = report.links_not_reached();
  if (empty > 0) text += "; on " + std::to_string(empty) + " no path was found though there is one";
  return text;
}

std::vector<std::string> sampling_notes(const SamplingReport& report) {
  if (!report.is_sampled) return {};
  std::vector<std::string> lines{"sampled: " + counted(report.rays, "ray") +
                                 (report.recall() ? " find " + percent(*report.recall()) + " of the paths" : "")};
  if (report.links.empty()) return {lines.front() + "; what they lack was not checked"};
  if (const std::string lack = missing(report); !lack.empty()) lines.push_back("powers lack " + lack);
  if (report.links_not_reached() > 0) {
    lines.push_back("no path found on " + std::to_string(report.links_not_reached()) + " of " +
                    counted(report.links.size(), "link") + " that have one");
  }
  lines.push_back("(" + counted(report.links.size(), "link") + " searched again " + again(report) + ")");
  return lines;
}

}  // namespace dcem::io
