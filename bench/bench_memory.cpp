/// What the exact memory saves, against how far things move from frame to frame.
///
///   bench_memory FILE.obj --mast X Y Z [--steps M...] [--cars N...] [--receivers N...] [--reflections N]
///                [--diffractions N] [--interactions N] [--frames N] [--warm N] [--within M] [--v2v] [--mast-step M]
///                [--threads N] [--settle N] [--column N] [--gap M]
///                [--processor-time] [--series FILE]
///
/// Receivers and cars drive straight through the streets of a city. Each frame is solved by two simulators in turns,
/// one that remembers and one that does not, and both must say the same to the last bit: otherwise exit 1. One CSV row
/// for each step, number of cars and number of receivers: milliseconds for a link and frame, and how much changed.
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/bench_program.hpp"
#include "bench/result_hash.hpp"
#include "bench/street_drive.hpp"
#include "dcem/core/statistics.hpp"
#include "dcem/sim/simulator.hpp"

namespace {

using dcem::CacheMode;
using dcem::bench::DriveOrder;

struct Options {
  std::string file;
  std::vector<double> mast_m;
  std::vector<double> steps_m{0.0, 0.014, 0.14, 0.5, 1.4};
  std::vector<std::size_t> cars{0}, receivers{10};
  int reflections = 2, diffractions = 1, interactions = 2;
  std::size_t frames = 40, warm = 0, settle = 4, column = 1;
  double within_m = 150.0, car_step_m = 1.0, gap_m = 20.0;
  std::optional<double> mast_step_m;
  bool between_vehicles = false, alone = false, processor_time = false, open_end = false;
  std::string series;
  unsigned threads = 1;
};

/// As many frames as there are; where the mast has listed all that it may before the first that is timed, very many.
std::optional<std::size_t> expected_frames(const Options& options, const DriveOrder& order) {
  if (options.open_end) return std::nullopt;
  return options.warm > 0 ? options.warm + order.frames : std::size_t{1'000'000};
}

dcem::SimulationSettings settings_of(const Options& options, const DriveOrder& order, CacheMode cache) {
  dcem::SimulationSettings settings;
  settings.frequency_hz = 30e9;
  settings.threads = options.threads;
  settings.propagation.max_reflections = options.reflections;
  settings.propagation.max_transmissions = 0;
  settings.propagation.max_diffractions = options.diffractions;
  settings.propagation.max_interactions = options.interactions;
  settings.propagation.discovery = dcem::Discovery::exact;
  settings.propagation.cache = cache;
  settings.expected_frames = expected_frames(options, order);
  return settings;
}

/// One simulator, frame by frame.
struct Contender {
  Contender(const dcem::Scene& scene, const Options& options, const DriveOrder& order, CacheMode mode)
      : simulator(scene, settings_of(options, order, mode)), processor_time(options.processor_time) {}

  dcem::FrameResult advance(double time_s, std::size_t index, bool timed) {
    const double before_s = processor_s();
    dcem::FrameResult result = simulator.advance_to(time_s, index);
    if (timed) {
      const std::size_t links = std::max<std::size_t>(1, result.links.size());
      const double frame_s = processor_time ? processor_s() - before_s : result.update_time_s + result.solve_time_s;
      ms.push_back(1e3 * frame_s / static_cast<double>(links));
      work += result.work;
      cache += result.cache;
    }
    return result;
  }

  /// That this process has used.
  static double processor_s() {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  }

  dcem::Simulator simulator;
  bool processor_time;
  std::vector<double> ms;  ///< for a link
  dcem::WorkCounters work;
  dcem::CacheCounters cache;
};

/// Each frame of both, appended: which of them are the longest.
void write_series(const std::string& file, const DriveOrder& order, const Contender& off, const Contender& exact) {
  std::ofstream out(file, std::ios::app);
  for (std::size_t frame = 0; frame < exact.ms.size(); ++frame) {
    out << order.step_m << ',' << order.cars << ',' << order.receivers << ',' << frame << ','
        << (frame < off.ms.size() ? off.ms[frame] : 0.0) << ',' << exact.ms[frame] << '\n';
  }
  if (!out) throw std::runtime_error(file + ": cannot be written");
}

bool bench(const Options& options, const DriveOrder& order) {
  const dcem::Scene scene = dcem::bench::street_drive(order);
  Contender off(scene, options, order, CacheMode::off), exact(scene, options, order, CacheMode::exact);
  // What a mast lists is worked out over many frames, here in which everything trembles.
  const std::size_t warm = options.warm > 0 ? options.warm : 10 + 4500 / std::max<std::size_t>(1, order.receivers);
  double cold_off_ms = 0.0, cold_exact_ms = 0.0;
  for (std::size_t index = 0; index < warm; ++index) {
    const double time_s = 1e-3 * static_cast<double>(index % 2);
    for (Contender* one : {&off, &exact}) {
      if (one == &off && options.alone) continue;
      const dcem::FrameResult result = one->advance(time_s, index, false);
      if (index == 0) (one == &off ? cold_off_ms : cold_exact_ms) = 1e3 * result.solve_time_s;
    }
  }
  std::size_t same = 0;
  std::uint64_t hash = 0;
  for (std::size_t frame = 0; frame < order.frames; ++frame) {
    const auto time_s = static_cast<double>(frame);
    // All of them have just started, from standing to their speed at once.
    const bool is_timed = frame >= options.settle;
    const dcem::FrameResult own = exact.advance(time_s, warm + frame, is_timed);
    if (options.alone) continue;
    const dcem::FrameResult expected = off.advance(time_s, warm + frame, is_timed);
    same += dcem::bench::hash_of(own, 0) == dcem::bench::hash_of(expected, 0) ? 1 : 0;
    hash = dcem::bench::hash_of(expected, hash);
  }
  if (!options.series.empty()) write_series(options.series, order, off, exact);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto frames = static_cast<double>(options.frames);
  dcem::bench::CsvRow row;
  row.text(std::filesystem::path(options.file).stem().string() + (order.mast_drives ? " v2v" : ""));
  row.count(options.threads).count(static_cast<std::size_t>(options.diffractions));
  row.count(static_cast<std::size_t>(options.interactions));
  row.number(order.step_m, 3).count(order.cars).count(order.receivers).count(options.frames);
  row.number(cold_off_ms, 1).number(cold_exact_ms, 1);
  if (options.alone) off.ms.assign(1, 0.0);
  for (const Contender* one : {&off, &exact}) {
    row.number(std::accumulate(one->ms.begin(), one->ms.end(), 0.0) / static_cast<double>(one->ms.size()), 4)
        .number(dcem::median(one->ms), 4)
        .number(dcem::quantile(one->ms, 0.95), 4)
        .number(dcem::quantile(one->ms, 1.0), 4);
  }
  row.number(dcem::median(off.ms) / dcem::median(exact.ms), 2);
  row.number(static_cast<double>(off.work.paths) / frames / static_cast<double>(order.receivers), 1);
  row.number(static_cast<double>(exact.cache.born) / frames, 2)
      .number(static_cast<double>(exact.cache.died) / frames, 2);
  row.number(static_cast<double>(off.work.sequences_solved) / frames, 1);
  row.number(static_cast<double>(exact.work.sequences_solved) / frames, 1);
  row.number(static_cast<double>(off.work.legs) / frames, 1).number(static_cast<double>(exact.work.legs) / frames, 1);
  row.number(static_cast<double>(usage.ru_maxrss) / 1024.0, 0).count(same).hash(hash).print();
  if (options.alone || same == order.frames) return true;
  std::fputs("frames differ\n", stderr);
  return false;
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  CLI::App app("Times the exact memory against how far things move");
  app.add_option("FILE", options.file, "OBJ file, in metres, z up")->required();
  app.add_option("--mast", options.mast_m, "where the transmitter stands")->required()->expected(3);
  app.add_option("--steps", options.steps_m, "of receivers, metres a frame");
  app.add_option("--cars", options.cars, "how many cars drive");
  app.add_option("--car-step", options.car_step_m, "of cars, metres a frame");
  app.add_option("--receivers", options.receivers, "how many there are");
  app.add_option("--within", options.within_m, "of the mast, along both axes, m")->check(CLI::PositiveNumber);
  app.add_option("--reflections", options.reflections, "at most")->check(CLI::Range(0, 3));
  app.add_option("--diffractions", options.diffractions, "at most")->check(CLI::Range(0, 2));
  app.add_option("--interactions", options.interactions, "at most")->check(CLI::Range(0, 3));
  app.add_option("--frames", options.frames, "that are timed")->check(CLI::Range(2, 100'000));
  app.add_option("--warm", options.warm, "frames before those that are timed; 0: as many as lists of a mast may take");
  app.add_option("--settle", options.settle, "frames that are driven before those that are timed");
  app.add_option("--column", options.column, "how many receivers drive one behind the other")
      ->check(CLI::Range(1, 1000));
  app.add_option("--gap", options.gap_m, "between these, m")->check(CLI::PositiveNumber);
  app.add_option("--threads", options.threads, "of each simulator")->check(CLI::Range(1, 1024));
  app.add_flag("--alone", options.alone, "with memory alone, to look into: nothing is compared");
  app.add_flag("--processor-time", options.processor_time, "of all threads instead of that by the clock");
  app.add_flag("--open-end", options.open_end, "how many frames there will be is not known to the simulators");
  app.add_option("--series", options.series, "a file that each frame is appended to");
  app.add_flag("--v2v", options.between_vehicles, "the transmitter drives, too");
  app.add_option("--mast-step", options.mast_step_m,
                 "of a transmitter that drives, metres a frame; default: as receivers");
  return dcem::bench::run_program(app, count, arguments, [&] {
    std::puts(
        "scene,threads,max_diffractions,max_interactions,step_m,cars,receivers,frames,cold_off_ms,cold_exact_ms,off_"
        "mean_ms,"
        "off_median_ms,off_p95_ms,off_maximum_ms,exact_mean_ms,exact_median_ms,exact_p95_ms,exact_maximum_ms,gain,"
        "paths_a_link,births,deaths,solved_off,"
        "solved_exact,legs_off,legs_exact,memory_mb,identical,hash");
    bool all_same = true;
    for (const std::size_t cars : options.cars) {
      for (const std::size_t receivers : options.receivers) {
        for (const double step_m : options.steps_m) {
          const dcem::Vec3 mast_m(options.mast_m[0], options.mast_m[1], options.mast_m[2]);
          all_same = bench(options, {options.file, mast_m, options.between_vehicles, options.mast_step_m,
                                     options.within_m, step_m, receivers, cars, options.frames + options.settle,
                                     options.car_step_m, options.column, options.gap_m}) &&
                     all_same;
        }
      }
    }
    return all_same;
  });
}
