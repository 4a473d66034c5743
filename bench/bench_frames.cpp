/// Times the frames of scenarios, with counters and a hash of all paths.
///
///   bench_frames ROUNDS SCENARIO.json... [--frames N] [--diffractions N]
///
/// Each scenario is run with the cache off and, where discovery is sampled, with cache `seed`; with the default cache
/// under the three policies of keeping the tree; each with one thread and with all cores. Configurations take turns
/// within a round. One CSV row per configuration: medians over the rounds, work counters, and the hash of every number
/// of every path. Rounds, thread counts or policies of one cache mode whose hashes differ are an error: exit 1 and no
/// row.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_program.hpp"
#include "bench/result_hash.hpp"
#include "dcem/core/statistics.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/dcem.hpp"
#include "dcem/io/frame_source.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/sim/discovery.hpp"
#include "dcem/sim/simulator.hpp"

namespace {

using dcem::CacheMode;
using dcem::TreePolicy;

struct Totals {
  dcem::WorkCounters work;
  dcem::CacheCounters cache;
  std::uint64_t nodes_refit = 0, nodes_rebuilt = 0, hash = 0;

  void add(const dcem::FrameResult& result) {
    work += result.work;
    cache += result.cache;
    nodes_refit += result.tree.nodes_refit;
    nodes_rebuilt += result.tree.nodes_rebuilt;
    hash = dcem::bench::hash_of(result, hash);
  }
};

/// One row: what is run, and for each round what it took. Times in milliseconds; steady: frames from 1 on.
struct Configuration {
  CacheMode cache = CacheMode::off;
  TreePolicy policy = TreePolicy::adaptive;
  unsigned threads = 1;
  std::vector<double> cold_ms{}, median_ms{}, p95_ms{}, maximum_ms{}, update_ms{}, source_ms{};
  Totals totals{};  ///< of the last round
};

const char* name_of(CacheMode cache) {
  return cache == CacheMode::seed ? "seed" : cache == CacheMode::exact ? "exact" : "off";
}

const char* name_of(TreePolicy policy) {
  if (policy == TreePolicy::rebuild_always) return "rebuild_always";
  return policy == TreePolicy::refit_only ? "refit_only" : "adaptive";
}

std::vector<Configuration> configurations(const dcem::io::Scenario& scenario) {
  const dcem::Discovery discovery = dcem::resolve_discovery(scenario.settings.propagation, scenario.scene);
  const bool sampled = discovery == dcem::Discovery::sampled;
  const CacheMode usual = sampled ? CacheMode::seed : CacheMode::exact;
  std::vector<unsigned> thread_counts{1, dcem::resolve_thread_count(0)};
  if (thread_counts[1] == 1) thread_counts.pop_back();
  std::vector<Configuration> all;
  for (const unsigned threads : thread_counts) {
    all.push_back({CacheMode::off, TreePolicy::adaptive, threads});
    all.push_back({usual, TreePolicy::adaptive, threads});
    all.push_back({usual, TreePolicy::rebuild_always, threads});
    all.push_back({usual, TreePolicy::refit_only, threads});
  }
  return all;
}

void run_once(const dcem::io::Scenario& scenario, std::size_t frames, Configuration& configuration) {
  dcem::SimulationSettings settings = scenario.settings;
  settings.threads = configuration.threads;
  settings.propagation.cache = configuration.cache;
  settings.tree.policy = configuration.policy;
  settings.expected_frames = frames;  // as dcem run says
  dcem::Simulator simulator(scenario.scene, settings);
  dcem::io::FrameSource source(scenario);
  std::vector<double> frame_ms, update_ms, source_ms;
  configuration.totals = {};
  for (std::size_t index = 0; index < frames; ++index) {
    const dcem::bench::Stopwatch source_watch;
    const dcem::Frame frame = source.frame(simulator.scene(), index);
    source_ms.push_back(source_watch.elapsed_ms());
    const dcem::FrameResult result = simulator.advance(frame);
    frame_ms.push_back(1e3 * (result.update_time_s + result.solve_time_s));
    update_ms.push_back(1e3 * result.update_time_s);
    configuration.totals.add(result);
  }
  const std::vector<double> steady_ms(frame_ms.begin() + 1, frame_ms.end());
  configuration.cold_ms.push_back(frame_ms.front());
  configuration.median_ms.push_back(dcem::median(steady_ms));
  configuration.p95_ms.push_back(dcem::quantile(steady_ms, 0.95));
  configuration.maximum_ms.push_back(dcem::quantile(steady_ms, 1.0));
  configuration.update_ms.push_back(dcem::median({update_ms.begin() + 1, update_ms.end()}));
  configuration.source_ms.push_back(dcem::median({source_ms.begin() + 1, source_ms.end()}));
}

void print(const dcem::io::Scenario& scenario, std::size_t frames, const Configuration& row,
           const Configuration& without_cache) {
  using dcem::median;
  const double step_s = (scenario.time_s(frames - 1) - scenario.time_s(0)) / static_cast<double>(frames - 1);
  const double steady_ms = median(row.median_ms);
  const dcem::WorkCounters& work = row.totals.work;
  dcem::bench::CsvRow csv;
  csv.text(scenario.name).count(scenario.scene.facets().size()).count(frames);
  csv.count(static_cast<std::size_t>(dcem::diffraction_order(scenario.settings.propagation)));
  csv.text(name_of(row.cache)).text(name_of(row.policy)).count(row.threads);
  csv.number(steady_ms / median(without_cache.median_ms), 3);
  csv.number(median(row.cold_ms), 3).number(steady_ms, 3).number(median(row.p95_ms), 3);
  csv.number(median(row.maximum_ms), 3).number(median(row.update_ms), 3).number(median(row.source_ms), 3);
  csv.number(1e3 * step_s / steady_ms, 2);
  csv.count(work.paths).count(work.rays).count(work.sequences_proposed).count(work.sequences_solved).count(work.legs);
  csv.count(work.nodes_visited).count(work.primitives_tested);
  csv.count(row.totals.nodes_refit).count(row.totals.nodes_rebuilt);
  csv.count(row.totals.cache.reused).count(row.totals.cache.born).count(row.totals.cache.died);
  csv.hash(row.totals.hash).print();
}

/// Whether everything that must be as `one` has brought the same result so far: what is sampled depends on what is
/// remembered, what is exact does not.
bool agree(const std::vector<Configuration>& all, const Configuration& one) {
  const auto is_sampled = [](const Configuration& of) { return of.cache == CacheMode::seed; };
  const bool any_is_sampled = std::any_of(all.begin(), all.end(), is_sampled);
  return std::all_of(all.begin(), all.end(), [&](const Configuration& other) {
    if (any_is_sampled && other.cache != one.cache) return true;
    return other.cold_ms.empty() || other.totals.hash == one.totals.hash;
  });
}

/// False where results differ that must not.
bool bench(const std::string& file, int rounds, std::size_t frames_wanted, std::optional<int> diffractions) {
  dcem::io::Scenario scenario = dcem::io::load_scenario(file);
  if (diffractions) scenario.settings.propagation.max_diffractions = *diffractions;
  const std::size_t frames = std::min(scenario.time.frames, frames_wanted);
  if (frames < 2) throw std::invalid_argument(file + ": one frame only; expected two or more");
  std::vector<Configuration> all = configurations(scenario);
  for (int round = 0; round < rounds; ++round) {
    for (Configuration& one : all) {
      run_once(scenario, frames, one);
      if (agree(all, one)) continue;
      std::fprintf(stderr, "%s: results differ between rounds, thread counts or policies (cache %s, %s, %u threads)\n",
                   file.c_str(), name_of(one.cache), name_of(one.policy), one.threads);
      return false;
    }
  }
  for (const Configuration& row : all) {
    const auto without_cache = std::find_if(all.begin(), all.end(), [&](const Configuration& other) {
      return other.threads == row.threads && other.cache == CacheMode::off;
    });
    print(scenario, frames, row, *without_cache);
  }
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  int rounds = 1;
  std::size_t frames = static_cast<std::size_t>(-1);
  std::optional<int> diffractions;
  std::vector<std::string> files;
  CLI::App app("Times the frames of scenarios");
  app.add_option("ROUNDS", rounds, "how often each configuration is run")->required()->check(CLI::Range(1, 1'000'000));
  app.add_option("SCENARIO", files, "scenario files")->required();
  app.add_option("--diffractions", diffractions, "in place of the scenarios' own number")->check(CLI::Range(0, 3));
  app.add_option("--frames", frames, "at most so many frames of each scenario")->check(CLI::Range(2, 1 << 30));
  return dcem::bench::run_program(app, count, arguments, [&] {
    std::puts(
        "scenario,facets,frames,max_diffractions,cache,policy,threads,ratio_to_cache_off,cold_frame_ms,steady_median_"
        "ms,p95_ms,"
        "maximum_ms,update_median_ms,source_median_ms,real_time_factor,paths,rays,sequences_proposed,sequences_solved,"
        "legs,nodes_visited,primitives_tested,nodes_refit,nodes_rebuilt,cache_reused,cache_born,cache_died,hash");
    return std::all_of(files.begin(), files.end(),
                       [&](const std::string& file) { return bench(file, rounds, frames, diffractions); });
  });
}
