/// Times maps, with what all their points share and without it, with counters and a hash of every point's numbers.
///
///   bench_map ROUNDS SCENARIO.json... [--alone K]
///
/// Makes the maps of each grid of a scenario, in its first frame, with `SimulationSettings::share_map_work` on and off,
/// each with one thread and with all cores. Configurations take turns within a round. One CSV row per configuration:
/// medians over the rounds. With `--alone K`, every K-th point is solved once more by a simulator of its own, whose
/// scene has that point as its only receiver, as in `dcem run`. Rounds, configurations or points alone that differ in
/// any bit are an error: exit 1 and no row.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <stdexcept>
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

using Maps = std::vector<dcem::RadioMap>;

/// One row: what is run, and for each round what it took.
struct Configuration {
  bool shared = true;
  unsigned threads = 1;
  std::vector<double> map_ms{};
  dcem::WorkCounters work{};  ///< of the last round
  std::uint64_t hash = 0;     ///< likewise
};

/// What points took that were solved by themselves, without building the tree.
struct Alone {
  std::vector<double> point_ms{};
};

/// A scenario in its first frame, with one of its grids.
struct Case {
  const dcem::io::Scenario& scenario;
  const dcem::ReceiverGrid& grid;
  dcem::Frame frame;
};

std::vector<Configuration> configurations() {
  std::vector<unsigned> thread_counts{1, dcem::resolve_thread_count(0)};
  if (thread_counts[1] == 1) thread_counts.pop_back();
  std::vector<Configuration> all;
  for (const unsigned threads : thread_counts) {
    for (const bool shared : {false, true}) all.push_back({shared, threads});
  }
  return all;
}

std::uint64_t hash_of(const Maps& maps) {
  std::uint64_t hash = 0;
  for (const dcem::RadioMap& map : maps) {
    for (const dcem::RadioMapPoint& point : map.points) hash = dcem::bench::hash_of(point, hash);
  }
  return hash;
}

Maps run_once(const Case& map_case, Configuration& configuration) {
  dcem::SimulationSettings settings = map_case.scenario.settings;
  settings.share_map_work = configuration.shared;
  settings.threads = configuration.threads;
  dcem::Simulator simulator(map_case.scenario.scene, settings);
  simulator.move_to(map_case.frame);
  configuration.work = {};
  const dcem::bench::Stopwatch watch;
  Maps maps = simulator.radio_maps(map_case.grid, {}, &configuration.work);
  configuration.map_ms.push_back(watch.elapsed_ms());
  configuration.hash = hash_of(maps);
  return maps;
}

/// Points that are not obstructed, for they alone are solved.
std::size_t computed_points(const Maps& maps) {
  const auto& points = maps.at(0).points;
  const auto computed = [](const dcem::RadioMapPoint& point) { return !point.obstructed; };
  return static_cast<std::size_t>(std::count_if(points.begin(), points.end(), computed));
}

std::string strongest_kinds(const dcem::LinkResult& link) {
  const auto weaker = [](const auto& a, const auto& b) { return a.power_ratio < b.power_ratio; };
  const auto strongest = std::max_element(link.paths.begin(), link.paths.end(), weaker);
  return strongest == link.paths.end() ? std::string() : dcem::kinds(strongest->path);
}

/// Solves one point by itself and returns the milliseconds that took, or nothing where the maps say something else.
std::optional<double> solve_alone(const Case& map_case, const Maps& maps, std::size_t cell) {
  const std::size_t row = cell / map_case.grid.columns(), column = cell % map_case.grid.columns();
  dcem::Scene scene = map_case.scenario.scene;
  scene.add_receiver(dcem::grid_receiver(map_case.grid, row, column));
  dcem::SimulationSettings settings = map_case.scenario.settings;
  settings.threads = 1;
  dcem::Simulator simulator(std::move(scene), settings);
  const dcem::FrameResult result = simulator.advance(map_case.frame);
  for (const dcem::LinkResult& link : result.links) {
    const dcem::Vec3 position_m = dcem::grid_point_m(map_case.grid, row, column);
    const dcem::RadioMapPoint point{position_m, false, link.statistics, strongest_kinds(link)};
    const dcem::RadioMapPoint& of_map = maps.at(link.transmitter).points.at(cell);
    if (dcem::bench::hash_of(point, 0) != dcem::bench::hash_of(of_map, 0)) return std::nullopt;
  }
  return 1e3 * result.solve_time_s;
}

/// Every `every`-th point of the grid that is not obstructed, each by itself. Nothing where a map differs.
std::optional<Alone> compare_alone(const Case& map_case, const Maps& maps, std::size_t every) {
  std::vector<std::size_t> cells;
  for (std::size_t cell = 0; cell < map_case.grid.size(); cell += every) {
    if (!maps.at(0).points[cell].obstructed) cells.push_back(cell);
  }
  std::vector<std::optional<double>> point_ms(cells.size());
  dcem::parallel_for(cells.size(), 0,
                     [&](std::size_t index, unsigned) { point_ms[index] = solve_alone(map_case, maps, cells[index]); });
  Alone alone;
  for (std::size_t index = 0; index < cells.size(); ++index) {
    if (!point_ms[index]) {
      std::fprintf(stderr, "%s: the map differs from its point %zu solved alone\n", map_case.scenario.name.c_str(),
                   cells[index]);
      return std::nullopt;
    }
    alone.point_ms.push_back(*point_ms[index]);
  }
  return alone;
}

void print(const Case& map_case, const Maps& maps, const Configuration& row, const Configuration& unshared,
           const Alone& alone) {
  using dcem::median;
  const dcem::io::Scenario& scenario = map_case.scenario;
  const bool exact = dcem::resolve_discovery(scenario.settings.propagation, scenario.scene) == dcem::Discovery::exact;
  const auto computed = static_cast<double>(computed_points(maps));
  const double map_ms = median(row.map_ms);
  dcem::bench::CsvRow csv;
  csv.text(scenario.name).text(map_case.grid.id).count(scenario.scene.facets().size());
  csv.count(scenario.scene.wedges().size()).count(maps.size()).text(exact ? "exact" : "sampled");
  csv.count(map_case.grid.size()).count(computed_points(maps)).text(row.shared ? "on" : "off").count(row.threads);
  csv.number(map_ms / median(unshared.map_ms), 3).number(map_ms / computed, 4);
  csv.number(1e-3 * map_ms, 3);
  if (alone.point_ms.empty()) csv.count(0).empty();
  if (!alone.point_ms.empty()) csv.count(alone.point_ms.size()).number(dcem::mean(alone.point_ms), 4);
  const dcem::WorkCounters& work = row.work;
  csv.count(work.paths).count(work.rays).count(work.sequences_proposed).count(work.sequences_solved).count(work.legs);
  csv.count(work.nodes_visited).count(work.primitives_tested).hash(row.hash).print();
}

/// False where results differ that must not.
bool bench(const Case& map_case, int rounds, std::size_t alone_every) {
  std::vector<Configuration> all = configurations();
  Maps maps;
  std::uint64_t hash = 0;
  for (int round = 0; round < rounds; ++round) {
    for (Configuration& one : all) {
      Maps now = run_once(map_case, one);
      if (maps.empty()) {
        maps = std::move(now);
        hash = one.hash;
      }
      if (one.hash == hash) continue;
      std::fprintf(stderr, "%s: maps differ between rounds or configurations (share_map_work %s, %u threads)\n",
                   map_case.scenario.name.c_str(), one.shared ? "on" : "off", one.threads);
      return false;
    }
  }
  if (computed_points(maps) == 0) throw std::invalid_argument(map_case.grid.id + ": no point of the grid is free");
  const std::optional<Alone> alone = alone_every > 0 ? compare_alone(map_case, maps, alone_every) : Alone{};
  if (!alone) return false;
  for (const Configuration& row : all) {
    const auto unshared = std::find_if(all.begin(), all.end(), [&](const Configuration& other) {
      return other.threads == row.threads && !other.shared;
    });
    print(map_case, maps, row, *unshared, *alone);
  }
  return true;
}

/// Checks what the benchmark takes for granted, and goes through the grids.
bool bench(const std::string& file, int rounds, std::size_t alone_every) {
  const dcem::io::Scenario scenario = dcem::io::load_scenario(file);
  if (scenario.grids.empty()) throw std::invalid_argument(file + ": no grid; expected a receiver with 'grid'");
  if (scenario.scene.transmitters().empty()) throw std::invalid_argument(file + ": no transmitter; expected one");
  if (alone_every > 0 && !scenario.scene.receivers().empty()) {
    throw std::invalid_argument(file + ": receivers beside the grid; expected none with --alone");
  }
  dcem::io::FrameSource source(scenario);
  const dcem::Frame frame = source.frame(scenario.scene, 0);
  return std::all_of(scenario.grids.begin(), scenario.grids.end(), [&](const dcem::ReceiverGrid& grid) {
    return bench(Case{scenario, grid, frame}, rounds, alone_every);
  });
}

}  // namespace

int main(int count, char** arguments) {
  int rounds = 1;
  std::size_t alone_every = 0;
  std::vector<std::string> files;
  CLI::App app("Times maps with and without what their points share");
  app.add_option("ROUNDS", rounds, "how often each configuration is run")->required()->check(CLI::Range(1, 1'000'000));
  app.add_option("SCENARIO", files, "scenario files")->required();
  app.add_option("--alone", alone_every, "solve every so-many-th point by itself, too; must be the same")
      ->check(CLI::Range(1, 1 << 30));
  return dcem::bench::run_program(app, count, arguments, [&] {
    std::puts(
        "scenario,grid,facets,edges,transmitters,discovery,points,points_computed,shared,threads,ratio_to_unshared,"
        "ms_per_point,map_s,points_alone,alone_ms_per_point,paths,rays,sequences_proposed,sequences_solved,legs,"
        "nodes_visited,primitives_tested,hash");
    return std::all_of(files.begin(), files.end(),
                       [&](const std::string& file) { return bench(file, rounds, alone_every); });
  });
}
