/// Times the frames of scenarios, with counters and a hash of all paths.
///
///   bench_drive ROUNDS SCENARIO.json...
///
/// Each scenario is run ROUNDS times with one thread and ROUNDS times with all cores, interleaved. One CSV row per
/// scenario and thread count goes to standard output: medians over the rounds, work counters, and the hash of every
/// number of every path. Rounds whose hashes differ are an error: exit 1 and no row.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "bench/result_hash.hpp"
#include "dcem/dcem.hpp"
#include "dcem/io/compiled_simulator.hpp"
#include "dcem/io/scenario.hpp"

namespace {

struct Round {
  std::vector<double> frame_ms;  ///< update and solve, per frame
  dcem::WorkCounters work;
  std::uint64_t hash = 0;
};

struct Row {
  unsigned threads = 1;
  std::vector<double> first_ms, median_ms, p95_ms, longest_ms;  ///< one entry per round
  Round last;
};

Round run_once(const dcem::io::Scenario& scenario, unsigned threads) {
  dcem::SimulationSettings settings = scenario.settings;
  settings.threads = threads;
  dcem::Simulator simulator(scenario.scene, settings);
  Round round;
  for (std::size_t frame = 0; frame < scenario.time.frames; ++frame) {
    const dcem::FrameResult result = simulator.advance_to(scenario.time_s(frame), frame);
    round.frame_ms.push_back(1e3 * (result.update_time_s + result.solve_time_s));
    round.work += result.work;
    round.hash = dcem::bench::hash_of(result, round.hash);
  }
  return round;
}

void add(Row& row, Round round) {
  row.first_ms.push_back(round.frame_ms.front());
  row.median_ms.push_back(dcem::median(round.frame_ms));
  row.p95_ms.push_back(dcem::quantile(round.frame_ms, 0.95));
  row.longest_ms.push_back(dcem::quantile(round.frame_ms, 1.0));
  row.last = std::move(round);
}

void print(const dcem::io::Scenario& scenario, const Row& row) {
  const dcem::WorkCounters& work = row.last.work;
  std::printf("%s,%zu,%zu,%u,%.3f,%.3f,%.3f,%.3f,%.1f,%llu,%llu,%llu,%llu,%llu,%llu,%016llx\n", scenario.name.c_str(),
              scenario.scene.facets().size(), scenario.time.frames, row.threads, dcem::median(row.first_ms),
              dcem::median(row.median_ms), dcem::median(row.p95_ms), dcem::median(row.longest_ms),
              1e3 * scenario.time.step_s / dcem::median(row.median_ms), static_cast<unsigned long long>(work.paths),
              static_cast<unsigned long long>(work.rays), static_cast<unsigned long long>(work.sequences_proposed),
              static_cast<unsigned long long>(work.legs), static_cast<unsigned long long>(work.nodes_visited),
              static_cast<unsigned long long>(work.primitives_tested), static_cast<unsigned long long>(row.last.hash));
  std::fflush(stdout);
}

/// False where two rounds of one scenario brought different results.
bool bench(const std::string& file, int rounds) {
  const dcem::io::Scenario scenario = dcem::io::load_scenario(file);
  Row one{1, {}, {}, {}, {}, {}}, all{dcem::resolve_thread_count(0), {}, {}, {}, {}, {}};
  std::uint64_t hash = 0;
  for (int round = 0; round < rounds; ++round) {
    add(one, run_once(scenario, one.threads));
    add(all, run_once(scenario, all.threads));
    if (round == 0) hash = one.last.hash;
    if (one.last.hash != hash || all.last.hash != hash) {
      std::fprintf(stderr, "%s: results differ between rounds or thread counts\n", file.c_str());
      return false;
    }
  }
  print(scenario, one);
  print(scenario, all);
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  const int rounds = count > 2 ? std::atoi(arguments[1]) : 0;
  if (rounds < 1) {
    std::fputs("usage: bench_drive ROUNDS SCENARIO.json...\n", stderr);
    return 2;
  }
  std::puts(
      "scenario,facets,frames,threads,first_frame_ms,median_frame_ms,p95_frame_ms,longest_frame_ms,real_time_factor,"
      "paths,"
      "rays,sequences_proposed,legs,nodes_visited,primitives_tested,hash");
  try {
    for (int index = 2; index < count; ++index) {
      if (!bench(arguments[index], rounds)) return 1;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
