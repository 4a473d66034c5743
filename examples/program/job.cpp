#include "job.hpp"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <iostream>
#include <string_view>

#include "dcem/io/frame_source.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/sampling_text.hpp"
#include "dcem/io/shard_facts.hpp"
#include "dcem/io/slow_search.hpp"
#include "dcem/io/text_table.hpp"
#include "dcem/sim/discovery.hpp"
#include "dcem/sim/link_choice.hpp"
#include "frequencies.hpp"

#ifndef DCEM_VERSION
#define DCEM_VERSION "unknown"
#endif

namespace dcem::program {
namespace {

std::optional<std::size_t> parse_count(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

FrameRange parse_frames(const std::string& text, std::size_t available) {
  if (text.empty()) return {0, available};
  const std::string expectation = "A:B with 0 <= A < B <= " + std::to_string(available);
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) throw UsageError("--frames " + text + ": no range of frames", expectation);
  const auto first = parse_count(std::string_view(text).substr(0, colon));
  const auto last = parse_count(std::string_view(text).substr(colon + 1));
  if (!first || !last) throw UsageError("--frames " + text + ": no range of frames", expectation);
  if (*first >= *last || *last > available) throw UsageError("--frames " + text + ": frame out of range", expectation);
  return {*first, *last};
}

/// What is remembered of what receivers see may take half of the memory there is. In one frame nothing is asked for
/// twice.
double most_remembered_bytes(const ScenarioOptions& options, std::size_t frames) {
  constexpr double by_default_bytes = 10e9;
  return frames < 2 ? 0.0 : 0.5 * options.memory_limit_bytes.value_or(by_default_bytes);
}

double memory_of_machine_bytes() {
  return static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace

std::string part_name(const ReceiverPart& part) {
  return std::to_string(part.part) + "-of-" + std::to_string(part.of);
}

std::string shard_ending(const ReceiverPart& part) {
  return ".shard-" + part_name(part);
}

std::string points_text(const std::string& kind, const std::string& id, std::size_t points) {
  return kind + " '" + id + "': " + std::to_string(points) + " points";
}

Job prepare_job(const ScenarioOptions& options) {
  const io::ProgressStage stage("reading scenario", progress_mode(options));
  Job job{io::load_scenario(options.scenario, options.overrides), {}, options.folder};
  constexpr double vehicle_bytes = 15e3;  // measured: box, facets, edges and tree
  const std::size_t vehicles = job.scenario.scene.slot_count();
  require_memory(options, std::to_string(vehicles) + " vehicles at a time", vehicles, vehicle_bytes);
  job.frames = parse_frames(options.frames, job.scenario.time.frames);
  require_memory(options, std::to_string(job.frames.count()) + " frames", job.frames.count(), sizeof(io::FrameFigures));
  io::require_attached_devices(job.scenario, job.frames.first, job.frames.last);
  if (options.threads) job.scenario.settings.threads = *options.threads;
  job.scenario.settings.links.receivers = options.shard;
  job.scenario.settings.most_remembered_bytes = most_remembered_bytes(options, job.frames.count());
  job.scenario.settings.expected_frames = job.frames.count();
  if (job.folder.empty()) job.folder = std::filesystem::path("out") / job.scenario.name;
  if (options.folder.empty() && options.shard) job.folder += shard_ending(*options.shard);
  return job;
}

Simulator make_simulator(Job& job, const ScenarioOptions& options) {
  return make_simulator(std::move(job.scenario.scene), job.scenario.settings, options);
}

Simulator make_simulator(Scene scene, const SimulationSettings& settings, const ScenarioOptions& options) {
  const io::ProgressStage stage("building tree", progress_mode(options));
  try {
    return {std::move(scene), settings};
  } catch (const std::invalid_argument& error) {
    throw io::InputError(options.scenario, error.what());
  }
}

void require_memory(const ScenarioOptions& options, const std::string& what, std::size_t count, double each_bytes) {
  const double most_bytes = options.memory_limit_bytes.value_or(memory_of_machine_bytes());
  const double needed_bytes = each_bytes * static_cast<double>(count);
  if (needed_bytes <= most_bytes) return;
  const std::string most = options.memory_limit_bytes
                               ? "at most " + io::memory_text(most_bytes) + ", the --memory-limit"
                               : "less than the " + io::memory_text(most_bytes) + " of this machine's memory";
  throw io::InputError(options.scenario, what + " need " + io::memory_text(needed_bytes) + "; expected " + most);
}

void expand_grids(io::Scenario& scenario, const ScenarioOptions& options) {
  const std::size_t transmitters = scenario.scene.transmitters().size();
  const double receiver_bytes = sizeof(Device) + static_cast<double>(transmitters) * sizeof(LinkResult);
  std::size_t receivers = scenario.scene.receivers().size();
  for (const ReceiverGrid& grid : scenario.grids) {
    require_memory(options, points_text("grid", grid.id, grid.size()), grid.size(), receiver_bytes);
    receivers += grid.size();
  }
  // Which links a range leaves, the frames say.
  if (takes_all_links(scenario.scene, scenario.settings.links)) {
    require_memory(options, std::to_string(receivers * transmitters) + " links of a frame", receivers, receiver_bytes);
  }
  for (const ReceiverGrid& grid : scenario.grids) {
    if (grid.samples_per_cell() > 1) {
      scenario.warnings.push_back("grid '" + grid.id + "': samples are for maps; here each cell has its centre alone");
    }
    for (std::size_t row = 0; row < grid.rows(); ++row) {
      for (std::size_t column = 0; column < grid.columns(); ++column) {
        try {
          scenario.scene.add_receiver(grid_receiver(grid, row, column));
        } catch (const std::invalid_argument& error) {
          throw io::InputError(options.scenario, error.what());
        }
      }
    }
  }
}

io::RunFacts run_facts(const Job& job, const Simulator& simulator, const SearchPlan& plan, std::size_t receivers) {
  const PropagationSettings& propagation = simulator.settings().propagation;
  return {DCEM_VERSION,
          job.scenario.name,
          simulator.settings(),
          plan.discovery,
          simulator.cache(),
          job.scenario.time,
          receivers,
          job.scenario.warnings,
          exactly_searched_interactions(propagation, plan),
          io::sampled_kinds(propagation, plan)};
}

std::size_t links_at_most(const Simulator& simulator) {
  const std::size_t all = simulator.scene().receivers().size() * simulator.scene().transmitters().size();
  const auto& pairs = simulator.settings().links.pairs;
  return pairs ? std::min(all, pairs->size()) : all;
}

void warn_of_slow_search(Job& job, const Simulator& simulator, const Device& receiver, std::size_t links) {
  const std::vector<double> chains = simulator.estimated_chains(receiver);
  if (const auto hint = io::slow_search_hint({chains, links, job.frames.count()})) {
    job.scenario.warnings.push_back(*hint);
  }
}

void print_warnings(const std::vector<std::string>& warnings, const ScenarioOptions& options) {
  if (options.quiet) return;
  const bool is_json = options.progress == io::ProgressMode::json;
  for (const std::string& warning : warnings) {
    std::cerr << (is_json ? io::warning_json(warning) : "warning: " + warning) + '\n';
  }
}

std::unique_ptr<io::ViewerWriter> make_viewer(io::OutputFolder& folder, const Job& job, const Simulator& simulator,
                                              std::size_t map_values_per_frame) {
  if (!job.scenario.output.html) return nullptr;
  const io::ViewerFacts facts{job.scenario.name, simulator.settings().frequency_hz, job.frames.first,
                              map_values_per_frame};
  return std::make_unique<io::ViewerWriter>(folder, simulator.scene(), facts, job.scenario.output.viewer);
}

void finish_viewer(io::ViewerWriter* viewer, io::RunSummary& summary, const std::vector<std::string>& notes) {
  if (viewer == nullptr) return;
  for (const std::string& notice : viewer->finish(notes)) summary.add_late_warning("viewer.html: " + notice);
}

io::RunIdentity run_identity(const Job& job, const ScenarioOptions& options) {
  const io::ScenarioOverrides& given = options.overrides;
  std::string text = "--frames " + std::to_string(job.frames.first) + ':' + std::to_string(job.frames.last);
  const auto add = [&](const char* option, const auto& value) {
    if constexpr (std::is_convertible_v<decltype(*value), std::string>) {
      if (value) text += ' ' + (option + (' ' + *value));
    } else {
      if (value) text += ' ' + (option + (' ' + std::to_string(*value)));
    }
  };
  if (given.frequency_hz) text += " --frequency " + frequency_text(*given.frequency_hz);
  add("--discovery", given.discovery);
  add("--cache", given.cache);
  add("--rays", given.rays);
  add("--seed", given.seed);
  add("--output", given.output);
  add("--output", options.map_output);
  return {DCEM_VERSION, io::content_hash(job.scenario.files), text};
}

io::RunIdentity part_identity(io::RunIdentity whole, const ReceiverPart& part) {
  whole.options += " --shard " + io::shard_text(part);
  return whole;
}

void require_effect(const ScenarioOptions& options, const Simulator& simulator) {
  if (simulator.discovery() == Discovery::sampled) return;
  const std::string why = " has no effect: discovery is exact, so that no ray is shot";
  if (options.overrides.rays) throw UsageError("--rays" + why, "--discovery sampled as well, or no --rays");
  const DiffuseSettings& diffuse = simulator.settings().propagation.diffuse;
  if (!options.overrides.seed || (diffuse.enabled && diffuse.phases == DiffusePhases::seeded)) return;
  throw UsageError("--seed" + why, "--discovery sampled as well, or no --seed");
}

ResultFolder::ResultFolder(std::filesystem::path folder, const std::string& scenario, const char* summary,
                           const char* other_summary)
    : files_(std::move(folder)),
      summary_(summary),
      former_(io::read_former_result(files_.path() / summary)),
      other_(io::read_former_result(files_.path() / other_summary)) {
  if (!other_ || other_->scenario.empty() || other_->scenario == scenario) return;
  throw io::InputError((files_.path() / other_summary).string(), "belongs to the results of scenario '" +
                                                                     other_->scenario + "', not of '" + scenario +
                                                                     "'; expected another folder (-o)");
}

void ResultFolder::require_free(const std::string& name) const {
  if (!other_ || std::find(other_->files.begin(), other_->files.end(), name) == other_->files.end()) return;
  throw io::InputError((files_.path() / name).string(),
                       "belongs to the results of another command in this folder; expected another folder (-o)");
}

void ResultFolder::commit(io::RunSummary& summary, const std::string& identity) {
  io::AtomicFile& file = files_.open(summary_);
  summary.set_files(identity, files_.names());
  summary.write_json([&](std::string_view part) { file.write(part); });
  std::vector<std::string> former = former_ ? former_->files : std::vector<std::string>{};
  if (other_) {
    const auto is_others = [&](const std::string& name) {
      return std::find(other_->files.begin(), other_->files.end(), name) != other_->files.end();
    };
    std::erase_if(former, is_others);
  }
  files_.commit(former);
}

io::ProgressMode progress_mode(const ScenarioOptions& options) {
  return options.quiet ? io::ProgressMode::never : options.progress;
}

}  // namespace dcem::program
