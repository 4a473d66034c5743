/// What rays find: effort and recall with and without memory, frame by frame.
///
///   bench_recall SCENARIO.json... [--frames N] [--every K] [--reference-rays N] [--threads N]
///
/// Three configurations of sampled discovery follow the scenario, one after the other within each frame: cache off with
/// 2000 rays, cache off with 200, and cache seed with 2000 in the first frame and 200 from then on. The reference is
/// exhaustive search where `automatic` would choose it; else it is what many rays find and what the configurations
/// find, taken together. One CSV row per configuration for each of the frames 0 to 20, for all frames, and for those
/// from 20 on. A path that exhaustive search denies is an error: exit 1.
#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_program.hpp"
#include "bench/result_hash.hpp"
#include "dcem/core/statistics.hpp"
#include "dcem/dcem.hpp"
#include "dcem/io/frame_source.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/sim/simulator.hpp"
#include "dcem/sim/verify/verifier.hpp"

namespace {

using dcem::CacheMode;
using Paths = std::vector<dcem::PathContribution>;

constexpr std::size_t last_frame_shown = 20;  ///< and the first of those that are steady

struct Options {
  std::vector<std::string> files;
  std::size_t frames = static_cast<std::size_t>(-1), every = 1;
  std::uint32_t reference_rays = 50'000;
  unsigned threads = 0;
};

/// One frame of one configuration.
struct Sample {
  std::size_t frame = 0;
  std::uint64_t rays = 0, paths = 0;
  double time_ms = 0.0;
  std::uint64_t hash = 0;                ///< of the frame's paths
  std::optional<dcem::Recall> recall{};  ///< nothing where the frame has no reference
};

struct Configuration {
  CacheMode cache;
  std::uint32_t rays;
  std::uint32_t rays_steady;
  dcem::Simulator simulator;
  std::vector<Sample> samples{};
};

Configuration configuration(const dcem::io::Scenario& scenario, const Options& options, CacheMode cache,
                            std::uint32_t rays, std::uint32_t rays_steady) {
  dcem::SimulationSettings settings = scenario.settings;
  settings.threads = options.threads;
  settings.propagation.discovery = dcem::Discovery::sampled;
  settings.propagation.cache = cache;
  settings.propagation.rays = rays;
  settings.propagation.rays_steady = rays_steady;
  return {cache, rays, rays_steady, dcem::Simulator(scenario.scene, settings)};
}

/// What there is to find.
class Reference {
 public:
  Reference(const dcem::io::Scenario& scenario, const Options& options)
      : simulator_(scenario.scene, settings(scenario, options)) {}

  bool is_exhaustive() const { return simulator_.discovery() == dcem::Discovery::exact; }
  dcem::FrameResult advance(const dcem::Frame& frame) { return simulator_.advance(frame); }

 private:
  static dcem::SimulationSettings settings(const dcem::io::Scenario& scenario, const Options& options) {
    dcem::SimulationSettings settings = scenario.settings;
    settings.threads = options.threads;
    settings.propagation.discovery = dcem::Discovery::automatic;
    settings.propagation.cache = CacheMode::off;
    settings.propagation.rays = options.reference_rays;
    return settings;
  }

  dcem::Simulator simulator_;
};

/// Adds the paths that `all` lacks; returns how many those are.
std::size_t unite(Paths& all, const Paths& found) {
  std::size_t missing = 0;
  for (const dcem::PathContribution& path : found) {
    if (dcem::detail::contains(all, path.path)) continue;
    all.push_back(path);
    ++missing;
  }
  return missing;
}

/// Compares all configurations in one frame. False where one has a path that exhaustive search denies.
bool compare(const std::vector<dcem::FrameResult>& results, dcem::FrameResult&& reference, bool is_exhaustive,
             std::vector<Configuration>& configurations) {
  std::size_t missing = 0;
  for (const dcem::FrameResult& result : results) {
    for (std::size_t link = 0; link < result.links.size(); ++link) {
      missing += unite(reference.links.at(link).paths, result.links[link].paths);
    }
  }
  for (std::size_t index = 0; index < results.size(); ++index) {
    dcem::Recall recall;
    for (std::size_t link = 0; link < reference.links.size(); ++link) {
      recall += dcem::recall_of(results[index].links.at(link).paths, reference.links[link].paths);
    }
    configurations[index].samples.back().recall = recall;
  }
  return missing == 0 || !is_exhaustive;
}

bool follow(const dcem::io::Scenario& scenario, std::size_t frames, const Options& options, Reference& reference,
            std::vector<Configuration>& configurations) {
  dcem::io::FrameSource source(scenario);
  for (std::size_t index = 0; index < frames; ++index) {
    const dcem::Frame frame = source.frame(scenario.scene, index);
    std::vector<dcem::FrameResult> results(configurations.size());
    for (std::size_t turn = 0; turn < configurations.size(); ++turn) {
      const std::size_t which = (index + turn) % configurations.size();  // nobody always comes first
      dcem::FrameResult& result = results[which] = configurations[which].simulator.advance(frame);
      configurations[which].samples.push_back({index, result.work.rays, result.work.paths,
                                               1e3 * (result.update_time_s + result.solve_time_s),
                                               dcem::bench::hash_of(result, 0)});
    }
    if (index % options.every != 0) continue;
    if (compare(results, reference.advance(frame), reference.is_exhaustive(), configurations)) continue;
    std::fprintf(stderr, "%s, frame %zu: rays find a path that exhaustive search denies\n", scenario.name.c_str(),
                 index);
    return false;
  }
  return true;
}

/// One row over the samples [first, last); `label` says which frames they are.
void print(const dcem::io::Scenario& scenario, const Options& options, bool is_exhaustive, const Configuration& row,
           const std::string& label, std::size_t first, std::size_t last) {
  if (first >= last) return;
  std::vector<double> time_ms;
  std::uint64_t rays = 0, paths = 0, compared = 0, hash = 0;
  dcem::Recall recall;
  for (std::size_t index = first; index < last; ++index) {
    const Sample& sample = row.samples[index];
    time_ms.push_back(sample.time_ms);
    rays += sample.rays;
    paths += sample.paths;
    hash = dcem::hash_values(hash, sample.hash);
    if (!sample.recall) continue;
    recall += *sample.recall;
    ++compared;
  }
  const double count = static_cast<double>(last - first);
  dcem::bench::CsvRow csv;
  csv.text(scenario.name).count(scenario.scene.facets().size()).text(is_exhaustive ? "exhaustive" : "rays");
  if (is_exhaustive) csv.empty();
  if (!is_exhaustive) csv.count(options.reference_rays);
  csv.text(row.cache == CacheMode::seed ? "seed" : "off").count(row.rays).count(row.rays_steady).text(label);
  csv.number(static_cast<double>(rays) / count, 1).number(dcem::median(time_ms), 3);
  csv.number(static_cast<double>(paths) / count, 2).count(compared);
  if (compared > 0) csv.count(recall.paths_there).number(recall.by_count(), 4).number(recall.by_power(), 4);
  if (compared == 0) csv.empty().empty().empty();
  csv.hash(hash).print();
}

bool bench(const std::string& file, const Options& options) {
  const dcem::io::Scenario scenario = dcem::io::load_scenario(file);
  const std::size_t frames = std::min(scenario.time.frames, options.frames);
  Reference reference(scenario, options);
  std::vector<Configuration> configurations;
  configurations.push_back(configuration(scenario, options, CacheMode::off, 2000, 2000));
  configurations.push_back(configuration(scenario, options, CacheMode::off, 200, 200));
  configurations.push_back(configuration(scenario, options, CacheMode::seed, 2000, 200));
  if (!follow(scenario, frames, options, reference, configurations)) return false;
  for (const Configuration& row : configurations) {
    const auto rows = [&](const std::string& label, std::size_t first, std::size_t last) {
      print(scenario, options, reference.is_exhaustive(), row, label, first, last);
    };
    for (std::size_t frame = 0; frame <= last_frame_shown && frame < frames; ++frame) {
      rows(std::to_string(frame), frame, frame + 1);
    }
    rows("all", 0, frames);
    rows("from 20", last_frame_shown, frames);
  }
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  CLI::App app("What rays find, with and without memory");
  app.add_option("SCENARIO", options.files, "scenario files")->required();
  app.add_option("--frames", options.frames, "at most so many frames")->check(CLI::Range(1, 1 << 30));
  app.add_option("--every", options.every, "compare with the reference in every so-many-th frame")
      ->check(CLI::Range(1, 1 << 30));
  app.add_option("--reference-rays", options.reference_rays, "rays of the reference in large scenes")
      ->check(CLI::Range(1, 100'000'000));
  app.add_option("--threads", options.threads, "0: all cores")->check(CLI::Range(0, 1024));
  return dcem::bench::run_program(app, count, arguments, [&] {
    std::puts(
        "scenario,facets,reference,reference_rays,cache,rays,rays_steady,frame,rays_per_frame,frame_median_ms,"
        "paths_per_frame,frames_compared,paths_there,recall,power_recall,hash");
    return std::all_of(options.files.begin(), options.files.end(),
                       [&](const std::string& file) { return bench(file, options); });
  });
}
