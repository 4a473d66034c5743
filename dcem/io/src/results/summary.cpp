#include "dcem/io/summary.hpp"

#include <algorithm>
#include <fstream>
#include <numeric>
#include <optional>
#include <system_error>
#include <utility>

#include "dcem/core/statistics.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/sampling_text.hpp"
#include "dcem/io/src/results/fact_json.hpp"
#include "dcem/io/src/results/shard_json.hpp"
#include "dcem/io/src/scenario/enum_words.hpp"
#include "dcem/io/src/scenario/settings_json.hpp"
#include "dcem/io/src/text/json_values.hpp"
#include "dcem/io/text_table.hpp"
#include "dcem/sim/discovery.hpp"

namespace dcem::io {
namespace {

using Json = nlohmann::ordered_json;

Json box_json(const Scene& scene) {
  Aabb<double> box;
  for (const Aabb<double>& triangle : scene.triangle_boxes()) box.extend(triangle);
  for (const FoliageShell& crown : scene.foliage()) box.extend(crown.box);
  if (box.empty()) return nullptr;
  return {{"min_m", point_json(box.min)}, {"max_m", point_json(box.max)}};
}

SurfaceReport joint_report(const Scene& scene) {
  SurfaceReport sum;
  for (const Body& body : scene.bodies()) {
    if (body.is_slot) continue;  // made by the program, with nothing to mend
    const SurfaceReport& part = body.mesh.report;
    sum.vertices_read += part.vertices_read;
    sum.vertices_welded += part.vertices_welded;
    sum.triangles_read += part.triangles_read;
    sum.triangles_without_area += part.triangles_without_area;
    sum.triangles_repeated += part.triangles_repeated;
    sum.open_edges += part.open_edges;
    sum.crowded_edges += part.crowded_edges;
    sum.uneven_sets += part.uneven_sets;
    sum.closed_shells += part.closed_shells;
    sum.standing_shells += part.standing_shells;
    sum.wedges += part.wedges;
    sum.free_edges += part.free_edges;
  }
  return sum;
}

Json scene_json(const Scene& scene, std::size_t receivers) {
  Json materials = Json::object();
  for (const Material& material : scene.materials()) materials[material.name] = material_json(material);
  return {{"triangles", scene.triangles().size()},
          {"facets", scene.facets().size()},
          {"objects", scene.bodies().size() - 1 - scene.slot_count()},
          {"vehicle_slots", scene.slot_count()},
          {"transmitters", scene.transmitters().size()},
          {"receivers", receivers},
          {"bounding_box", box_json(scene)},
          {"surfaces", surface_report_json(joint_report(scene))},
          {"materials", materials}};
}

Json work_json(const WorkCounters& work) {
  return {{"rays", work.rays},
          {"legs", work.legs},
          {"sequences_proposed", work.sequences_proposed},
          {"sequences_solved", work.sequences_solved},
          {"diffuse_tiles", work.diffuse_tiles},
          {"diffuse_links_unfinished", work.diffuse_links_unfinished},
          {"diffuse_residual_db", work.diffuse_residual_db},
          {"nodes_visited", work.nodes_visited},
          {"primitives_tested", work.primitives_tested}};
}

Json tree_json(const TreeUpdateReport& tree) {
  return {{"nodes_kept", tree.nodes_kept},
          {"nodes_refit", tree.nodes_refit},
          {"nodes_rebuilt", tree.nodes_rebuilt},
          {"subtrees_rebuilt", tree.subtrees_rebuilt},
          {"root_rebuilt", tree.root_rebuilt},
          {"sah_cost", tree.sah_cost},
          {"sah_cost_at_build", tree.sah_cost_at_build}};
}

Json cache_json(const CacheCounters& cache) {
  return {{"taken_over", cache.taken_over},
          {"revalidated", cache.revalidated},
          {"reused", cache.reused},
          {"expired", cache.expired},
          {"born", cache.born},
          {"died", cache.died}};
}

Json sampling_json(const SamplingReport& report) {
  if (report.links.empty()) return {{"rays", report.rays}, {"links", 0}};
  return {{"rays", report.rays},
          {"rays_steady", report.rays_steady > 0 ? Json(report.rays_steady) : Json(nullptr)},
          {"searched_again", report.exact ? "exact" : "sampled"},
          {"rays_again", report.exact ? Json(nullptr) : Json(report.reference_rays)},
          {"links", report.links.size()},
          {"links_not_reached", report.links_not_reached()},
          {"recall", optional_json(report.recall())},
          {"missing_median_db", optional_json(report.missing_db(0.5))},
          {"missing_p95_db", optional_json(report.missing_db(0.95))}};
}

double total_time_s(const FrameFigures& frame) {
  return frame.update_time_s + frame.solve_time_s;
}

// How many times faster than the world the program is: the time that the frames cover over the time they took.
std::optional<double> real_time_factor(double covered_s, double spent_s) {
  return spent_s > 0.0 ? std::optional(covered_s / spent_s) : std::nullopt;
}

Json frame_json(const FrameFigures& frame, double step_s) {
  return {{"frame", frame.index},
          {"time_s", frame.time_s},
          {"links", frame.links},
          {"links_with_line_of_sight", frame.links_with_line_of_sight},
          {"paths", frame.paths},
          {"update_time_s", frame.update_time_s},
          {"solve_time_s", frame.solve_time_s},
          {"real_time_factor", optional_json(real_time_factor(step_s, total_time_s(frame)))},
          {"tree", tree_json(frame.tree)},
          {"cache", cache_json(frame.cache)},
          {"work", work_json(frame.work)}};
}

FrameFigures sum_of(const std::vector<FrameFigures>& frames) {
  FrameFigures sum;
  for (const FrameFigures& frame : frames) {
    sum.links += frame.links;
    sum.links_with_line_of_sight += frame.links_with_line_of_sight;
    sum.paths += frame.paths;
    sum.update_time_s += frame.update_time_s;
    sum.solve_time_s += frame.solve_time_s;
    sum.work += frame.work;
    sum.cache += frame.cache;
    sum.tree.nodes_kept += frame.tree.nodes_kept;
    sum.tree.nodes_refit += frame.tree.nodes_refit;
    sum.tree.nodes_rebuilt += frame.tree.nodes_rebuilt;
    sum.tree.subtrees_rebuilt += frame.tree.subtrees_rebuilt;
  }
  return sum;
}

std::vector<double> times_of(const std::vector<FrameFigures>& frames) {
  std::vector<double> times_s;
  for (const FrameFigures& frame : frames) times_s.push_back(total_time_s(frame));
  return times_s;
}

Json totals_json(const std::vector<FrameFigures>& frames, double step_s, const WorkTimes& work) {
  const FrameFigures sum = sum_of(frames);
  const std::vector<double> times_s = times_of(frames);
  const double covered_s = step_s * static_cast<double>(frames.size());
  return {{"frames", frames.size()},
          {"links", sum.links},
          {"links_with_line_of_sight", sum.links_with_line_of_sight},
          {"paths", sum.paths},
          {"update_time_s", sum.update_time_s},
          {"solve_time_s", sum.solve_time_s},
          {"serial_time_s", work.serial_s},
          {"parallel_time_s", work.parallel_s},
          {"beside_time_s", work.beside_s},
          {"longest_tasks_time_s", work.longest_tasks_s},
          {"frame_time_median_s", median(times_s)},
          {"frame_time_p95_s", quantile(times_s, 0.95)},
          {"frame_time_max_s", quantile(times_s, 1.0)},
          {"real_time_factor", optional_json(real_time_factor(covered_s, total_time_s(sum)))},
          {"tree",
           {{"nodes_kept", sum.tree.nodes_kept},
            {"nodes_refit", sum.tree.nodes_refit},
            {"nodes_rebuilt", sum.tree.nodes_rebuilt},
            {"subtrees_rebuilt", sum.tree.subtrees_rebuilt}}},
          {"cache", cache_json(sum.cache)},
          {"work", work_json(sum.work)}};
}

Json interruption_json(const std::optional<Interruption>& interruption) {
  if (!interruption) return nullptr;
  return {{"signal", interruption->signal},
          {"next_frame", interruption->next_frame},
          {"frames_left", interruption->beyond_frame - interruption->next_frame}};
}

std::string mean_text(std::size_t sum, std::size_t count) {
  return count == 0 ? "-" : format_fixed(static_cast<double>(sum) / static_cast<double>(count), 1);
}

std::string milliseconds(double duration_s) {
  return format_fixed(1e3 * duration_s, duration_s < 0.1 ? 2 : 0) + " ms";
}

}  // namespace

FrameFigures figures_of(const FrameResult& frame, ThreadPool* pool) {
  FrameFigures figures{frame.index,         frame.time_s,       frame.links.size(), 0,           0,
                       frame.update_time_s, frame.solve_time_s, frame.tree,         frame.cache, frame.work};
  struct Counts {
    std::size_t paths = 0, in_sight = 0;
  };
  constexpr std::size_t block = 4096;
  std::vector<Counts> counts((frame.links.size() + block - 1) / block);
  const auto count = [&](std::size_t number, unsigned) {
    for (std::size_t at = number * block; at < std::min(frame.links.size(), (number + 1) * block); ++at) {
      counts[number].paths += frame.links[at].paths.size();
      counts[number].in_sight += frame.links[at].statistics.line_of_sight ? 1U : 0U;
    }
  };
  ThreadPool alone(1);
  (pool != nullptr ? *pool : alone).for_each(counts.size(), count);
  for (const Counts& one : counts) {
    figures.paths += one.paths;
    figures.links_with_line_of_sight += one.in_sight;
  }
  return figures;
}

RunSummary::RunSummary(RunFacts facts, const Scene& scene) : facts_(std::move(facts)), scene_(scene) {}

std::string RunSummary::cache_text(const CacheCounters& cache) const {
  if (facts_.cache == CacheMode::off) return "off";
  return std::string(word_of(facts_.cache)) + ": " + std::to_string(cache.taken_over + cache.reused) +
         " paths reused, " + std::to_string(cache.born) + " born, " + std::to_string(cache.died) + " died";
}

std::vector<std::string> RunSummary::warnings() const {
  std::vector<std::string> all = facts_.warnings;
  const std::vector<std::string> late = late_warnings();
  all.insert(all.end(), late.begin(), late.end());
  return all;
}

std::vector<std::string> RunSummary::late_warnings() const {
  std::vector<std::string> lines = late_warnings_;
  if (sampling_.is_sampled) lines.push_back(sampling_warning(sampling_, facts_.sampled_kinds));
  const FrameFigures sum = sum_of(frames_);
  if (sum.work.diffuse_links_unfinished > 0) lines.push_back("diffuse power: " + diffuse_text(sum));
  return lines;
}

/// How many tiles the sums took, and what they may lack.
std::string RunSummary::diffuse_text(const FrameFigures& sum) const {
  const DiffuseSettings& settings = facts_.settings.propagation.diffuse;
  const std::string tiles = mean_text(sum.work.diffuse_tiles, sum.links) + " tiles per link";
  const std::string tolerance = format_fixed(settings.tolerance_db, settings.tolerance_db < 0.1 ? 4 : 2) + " dB";
  if (sum.work.diffuse_links_unfinished == 0) return tiles + ", all sums within " + tolerance;
  return tiles + "; " + std::to_string(sum.work.diffuse_links_unfinished) + " links not within " + tolerance +
         " after " + std::to_string(settings.tile_budget) + " tiles (residual up to " +
         format_fixed(sum.work.diffuse_residual_db, 2) + " dB)";
}

std::string RunSummary::json() const {
  std::string text;
  write_json([&](std::string_view part) { text += part; });
  return text;
}

void RunSummary::write_json(const std::function<void(std::string_view)>& write) const {
  Json head{{"version", facts_.version},
            {"scenario", facts_.scenario},
            {"identity", identity_},
            {"files", files_},
            {"interrupted", interruption_json(interruption_)}};
  if (shard_) head["shard"] = shard_json(*shard_);
  head["scene"] = scene_json(scene_, facts_.receivers);
  head["settings"] = settings_json(facts_);
  head["warnings"] = warnings();
  head["sampling"] = sampling_.is_sampled ? sampling_json(sampling_) : Json(nullptr);
  head["totals"] = totals_json(frames_, facts_.time.step_s, work_times_);
  std::string text = json_text(head);
  text.resize(text.rfind('}'));
  while (text.back() == '\n') text.pop_back();
  write(text + ",\n  \"frames\": [");
  // One by one: a day of frames as one document, or one text, would need gigabytes.
  for (const FrameFigures& frame : frames_) {
    write((&frame == frames_.data() ? "\n    " : ",\n    ") + frame_json(frame, facts_.time.step_s).dump());
  }
  write("\n  ]\n}\n");
}

std::string RunSummary::table(const std::filesystem::path& folder) const {
  const FrameFigures sum = sum_of(frames_);
  const std::vector<double> times_s = times_of(frames_);
  const double covered_s = facts_.time.step_s * static_cast<double>(frames_.size());
  const auto factor = real_time_factor(covered_s, total_time_s(sum));
  TextTable table({{"", TextTable::Align::left}, {"", TextTable::Align::left}});
  if (shard_) table.add_row({"part of a run", shard_text(shard_->part)});
  table.add_row({"frames", std::to_string(frames_.size())});
  table.add_row({"links", std::to_string(sum.links) + " (" + std::to_string(sum.links_with_line_of_sight) +
                              " with line of sight)"});
  table.add_row({"paths", std::to_string(sum.paths) + " (" + mean_text(sum.paths, frames_.size()) + " per frame, " +
                              mean_text(sum.paths, sum.links) + " per link)"});
  table.add_row({"time per frame", milliseconds(median(times_s)) + " median, " + milliseconds(quantile(times_s, 0.95)) +
                                       " 95 %, " + milliseconds(quantile(times_s, 1.0)) + " max"});
  table.add_row({"real-time factor", factor ? format_fixed(*factor, *factor < 10.0 ? 3 : 1) : "-"});
  table.add_row({"discovery", word_of(facts_.discovery)});
  table.add_row({"cache", cache_text(sum.cache)});
  for (const std::string& note : sampling_notes(sampling_)) table.add_row({"", note});
  if (facts_.settings.propagation.diffuse.enabled) table.add_row({"diffuse", diffuse_text(sum)});
  table.add_row({"tree", std::to_string(sum.tree.nodes_refit) + " nodes refit, " +
                             std::to_string(sum.tree.nodes_rebuilt) + " rebuilt in " +
                             std::to_string(sum.tree.subtrees_rebuilt) + " subtrees"});
  table.add_row({"rays", std::to_string(sum.work.rays)});
  table.add_row({"threads", std::to_string(resolve_thread_count(facts_.settings.threads))});
  table.add_row({"results", folder.string()});
  return table.str();
}

std::optional<FormerResult> read_former_result(const std::filesystem::path& summary) {
  std::error_code ignored;
  if (std::filesystem::is_directory(summary, ignored)) {
    throw InputError(summary.string(), "is a folder; expected a file, or nothing");
  }
  std::ifstream stream(summary);
  const Json document = Json::parse(stream, nullptr, false);
  if (!document.is_object() || !document.contains("version") || !document.contains("totals")) return std::nullopt;
  FormerResult former;
  if (document.contains("scenario") && document["scenario"].is_string()) former.scenario = document["scenario"];
  former.is_interrupted = document.contains("interrupted") && !document["interrupted"].is_null();
  if (document.contains("identity") && document["identity"].is_string()) former.identity = document["identity"];
  if (!document.contains("files") || !document["files"].is_array()) return former;
  for (const Json& name : document["files"]) {
    if (name.is_string()) former.files.push_back(name);
  }
  return former;
}

}  // namespace dcem::io
