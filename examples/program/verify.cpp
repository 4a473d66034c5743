/// `dcem verify`: runs a scenario and checks every frame against solutions of its own.
#include <iostream>
#include <stdexcept>

#include "dcem/io/frame_source.hpp"
#include "dcem/io/text_table.hpp"
#include "dcem/sim/verify/verifier.hpp"
#include "frequencies.hpp"
#include "job.hpp"
#include "stop_signal.hpp"

namespace dcem::program {
namespace {

constexpr std::size_t settled_frame = 20;  // a cache that starts empty has filled by then

const char* name_of(CacheMode cache) {
  return cache == CacheMode::seed ? "seed" : cache == CacheMode::exact ? "exact" : "off";
}

std::string percent(double share) {
  return io::format_fixed(100.0 * share, 3) + " %";
}

std::string share_text(const Recall& recall) {
  return percent(recall.by_count()) + " of " + std::to_string(recall.paths_there) + " paths, " +
         percent(recall.by_power()) + " of the power";
}

void add_recall(io::TextTable& table, const VerificationReport& report) {
  table.add_row({"recall of rays", share_text(report.recall)});
  if (report.recall_by_frame.size() <= settled_frame) return;
  Recall settled;
  for (std::size_t index = settled_frame; index < report.recall_by_frame.size(); ++index) {
    settled += report.recall_by_frame[index];
  }
  table.add_row({"from the 21st frame on", share_text(settled)});
}

std::string table_of(const VerificationReport& report, const Simulator& simulator) {
  const bool sampled = simulator.discovery() == Discovery::sampled;
  io::TextTable table({{"", io::TextTable::Align::left}, {"", io::TextTable::Align::left}});
  table.add_row({"frames", std::to_string(report.frames)});
  table.add_row({"links", std::to_string(report.links)});
  table.add_row({"discovery", sampled ? "sampled" : "exact"});
  table.add_row({"cache", name_of(simulator.cache())});
  table.add_row({"frames with other links", std::to_string(report.frames_with_other_links)});
  table.add_row({"paths solved on their own", std::to_string(report.paths)});
  table.add_row({"paths that differ", std::to_string(report.paths_different)});
  if (report.from_scratch) {
    table.add_row({"links that differ from scratch", std::to_string(report.links_different)});
  }
  if (!report.compared) {
    table.add_row({"exhaustive search", "not possible: too many facets"});
    return table.str();
  }
  table.add_row({"paths denied by exhaustive search", std::to_string(report.paths_extra)});
  add_recall(table, report);
  return table.str();
}

/// Of one frequency.
void verify_one(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  expand_grids(job.scenario, options);
  io::FrameSource frames(job.scenario);
  Simulator simulator = make_simulator(job, options);
  require_effect(options, simulator);
  Verifier verifier(simulator.scene(), simulator.settings());
  print_warnings(job.scenario.warnings, options);
  const StopRequest stop;
  std::size_t next = job.frames.first;
  {
    io::ProgressBar bar("frames", job.frames.count(), progress_mode(options));
    for (; next < job.frames.last && stop.signal() == 0; ++next) {
      const Frame frame = frames.frame(simulator.scene(), next);
      verifier.check(frame, simulator.advance(frame));
      bar.advance();
    }
  }
  const VerificationReport& report = verifier.report();
  if (!options.quiet) {
    std::cout << table_of(report, simulator) << std::flush;
    if (!std::cout) throw std::runtime_error("the output stream does not take the result");
  }
  if (report.passed()) {
    if (next == job.frames.last) return;
    throw Interrupted(stop.signal(), "interrupted by " + signal_name(stop.signal()) + ": " +
                                         std::to_string(report.frames) + " of " + std::to_string(job.frames.count()) +
                                         " frames are verified");
  }
  std::string problem = std::to_string(report.paths_different + report.paths_extra) + " paths, " +
                        std::to_string(report.links_different) + " links and " +
                        std::to_string(report.frames_with_other_links) + " lists of links are not as reported";
  for (const std::string& difference : report.differences) problem += "; " + difference;
  throw CheckFailed(problem);
}

}  // namespace

void verify_scenario(const ScenarioOptions& options) {
  for (const ScenarioOptions& one : by_frequency(options)) verify_one(one);
}

}  // namespace dcem::program
