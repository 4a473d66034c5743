/// `dcem map`: a coverage map per grid, transmitter and frame, and what all transmitters together do.
#include <chrono>
#include <iostream>
#include <set>

#include "dcem/channel/map_combination.hpp"
#include "dcem/channel/thermal_noise.hpp"
#include "dcem/io/combined_map_writer.hpp"
#include "dcem/io/frame_source.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/map_distribution.hpp"
#include "dcem/io/map_writer.hpp"
#include "job.hpp"

namespace dcem::program {
namespace {

constexpr const char* best_server_part = "best_server";
constexpr const char* sinr_part = "sinr";
constexpr const char* distribution_part = "distribution";

/// One frame's number for the file names, or nothing where there is only one frame.
std::optional<std::size_t> numbered(const Job& job, std::size_t frame) {
  return job.frames.count() > 1 ? std::optional(frame) : std::nullopt;
}

// Two ids may differ in a way that their file names do not, as in grids "a" and "a_b" with transmitters "b_c" and "c".
// The names of what is over all transmitters are taken as well.
void check_names(const Job& job, const std::string& file) {
  std::set<std::string> names;
  const auto take = [&](const ReceiverGrid& grid, const std::string& kind, const std::string& id) {
    const std::string name = io::map_name(grid.id, id, {});
    if (names.insert(name).second) return;
    throw io::InputError(file, "grid '" + grid.id + "' and " + kind + "'" + id + "' give the file name '" + name +
                                   "' a second time; expected ids that keep the names apart");
  };
  for (const ReceiverGrid& grid : job.scenario.grids) {
    for (const char* part : {best_server_part, sinr_part, distribution_part}) take(grid, "", part);
  }
  for (const ReceiverGrid& grid : job.scenario.grids) {
    for (const Device& transmitter : job.scenario.scene.transmitters()) take(grid, "transmitter ", transmitter.id);
  }
}

std::size_t point_count(const io::Scenario& scenario) {
  std::size_t points = 0;
  for (const ReceiverGrid& grid : scenario.grids) points += grid.size();
  return points;
}

void add_figures(const RadioMap& map, io::FrameFigures& figures) {
  for (const RadioMapPoint& point : map.points) {
    if (point.obstructed) continue;
    ++figures.links;
    figures.links_with_line_of_sight += point.statistics.line_of_sight ? 1U : 0U;
    figures.paths += point.statistics.path_count;
  }
}

/// Writes the files of the maps of one frame.
class MapFiles {
 public:
  MapFiles(io::OutputFolder& folder, const Job& job, const Simulator& simulator, const Frame& frame)
      : folder_(folder),
        wanted_(job.scenario.output.map),
        scene_(simulator.scene()),
        frame_(frame),
        number_(numbered(job, frame.index)),
        time_s_(number_ ? std::optional(frame.time_s) : std::nullopt),
        frequency_hz_(simulator.settings().frequency_hz) {
    if (job.scenario.noise) noise_dbm_ = noise_power_dbm(*job.scenario.noise);
  }

  void write(const std::vector<RadioMap>& maps) {
    for (const RadioMap& map : maps) write_one(map);
    if (maps.empty()) return;
    const CombinedMap combined = combine_maps(maps, noise_dbm_);
    write_best_server(combined);
    if (io::has_sinr(combined, noise_dbm_.has_value())) write_sinr(combined);
    const auto chart = [&](io::AtomicFile& file) { file.write(io::map_distribution_svg(maps, combined, time_s_)); };
    if (wanted_.svg) put(name_of(combined, distribution_part) + ".svg", chart);
  }

 private:
  template <typename Write>
  void put(const std::string& name, Write&& write) {
    io::AtomicFile& file = folder_.open(name);
    write(file);
    file.close();
  }

  std::string name_of(const CombinedMap& map, const char* part) const {
    return io::map_name(map.grid.id, part, number_);
  }

  void write_one(const RadioMap& map) {
    const std::string name = io::map_name(map.grid.id, map.transmitter, number_);
    if (wanted_.csv) put(name + ".csv", [&](auto& file) { io::write_map_csv(file, map, frequency_hz_); });
    if (wanted_.npz) put(name + ".npz", [&](auto& file) { io::write_map_npz(file, map, frequency_hz_); });
    if (wanted_.asc) put(name + ".asc", [&](auto& file) { io::write_map_asc(file, map); });
    const auto draw = [&](auto& file) {
      io::write_heat_map_png(io::map_picture(map, scene_, frame_, frequency_hz_, time_s_), file);
    };
    if (wanted_.png) put(name + ".png", draw);
  }

  void write_best_server(const CombinedMap& map) {
    const std::string name = name_of(map, best_server_part);
    if (wanted_.csv) put(name + ".csv", [&](auto& file) { io::write_best_server_csv(file, map); });
    if (wanted_.npz) put(name + ".npz", [&](auto& file) { io::write_best_server_npz(file, map); });
    if (wanted_.asc) put(name + ".asc", [&](auto& file) { io::write_best_server_asc(file, map); });
    const auto draw = [&](auto& file) {
      io::write_heat_map_png(io::best_server_picture(map, scene_, frame_, frequency_hz_, time_s_), file);
    };
    if (wanted_.png) put(name + ".png", draw);
  }

  void write_sinr(const CombinedMap& map) {
    const std::string name = name_of(map, sinr_part);
    if (wanted_.csv) put(name + ".csv", [&](auto& file) { io::write_sinr_csv(file, map); });
    if (wanted_.npz) put(name + ".npz", [&](auto& file) { io::write_sinr_npz(file, map); });
    if (wanted_.asc) put(name + ".asc", [&](auto& file) { io::write_sinr_asc(file, map); });
    const auto draw = [&](auto& file) {
      const bool has_noise = noise_dbm_.has_value();
      io::write_heat_map_png(io::sinr_picture(map, scene_, frame_, frequency_hz_, has_noise, time_s_), file);
    };
    if (wanted_.png) put(name + ".png", draw);
  }

  io::OutputFolder& folder_;
  const io::MapOutputs wanted_;
  const Scene& scene_;
  const Frame& frame_;
  const std::optional<std::size_t> number_;  ///< in the names of files; absent where there is one frame
  const std::optional<double> time_s_;
  const double frequency_hz_;
  std::optional<double> noise_dbm_;
};

io::FrameFigures map_frame(io::OutputFolder& folder, const Job& job, Simulator& simulator, const Frame& frame,
                           io::ViewerWriter* viewer, io::ProgressBar& bar) {
  const FrameResult result = simulator.advance(frame);
  io::FrameFigures figures = io::figures_of(result);
  if (viewer != nullptr) viewer->add(frame, result);
  for (const ReceiverGrid& grid : job.scenario.grids) {
    const auto start = std::chrono::steady_clock::now();
    const auto maps = simulator.radio_maps(
        grid, [&](std::size_t points) { bar.advance(points); }, &figures.work);
    figures.solve_time_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const RadioMap& map : maps) {
      add_figures(map, figures);
      if (viewer != nullptr) viewer->add(map);
    }
    MapFiles(folder, job, simulator, frame).write(maps);
  }
  return figures;
}

}  // namespace

void map_scenario(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  if (job.scenario.grids.empty()) {
    throw io::InputError(options.scenario, "no receiver is a grid; expected one with the key 'grid' to draw a map of");
  }
  check_names(job, options.scenario);
  const auto transmitters = static_cast<double>(job.scenario.scene.transmitters().size());
  require_grid_memory(job.scenario, options.scenario, transmitters * sizeof(RadioMapPoint));
  io::FrameSource frames(job.scenario);
  Simulator simulator = make_simulator(job, options);
  io::OutputFolder folder(job.folder);
  const std::size_t points = point_count(job.scenario);
  io::RunSummary summary(run_facts(job, simulator, simulator.map_plan(), points), simulator.scene());
  print_warnings(job.scenario.warnings, options);
  const auto viewer = make_viewer(folder, job, simulator, points * simulator.scene().transmitters().size());
  {
    io::ProgressBar bar("points", points * job.frames.count(), progress_mode(options));
    for (std::size_t frame = job.frames.first; frame < job.frames.last; ++frame) {
      summary.add(map_frame(folder, job, simulator, frames.frame(simulator.scene(), frame), viewer.get(), bar));
    }
  }
  finish_viewer(viewer.get(), summary);
  folder.open("map_summary.json").write(summary.json());
  folder.commit();
  print_warnings(summary.late_warnings(), options);
  if (!options.quiet) std::cout << summary.table(folder.path());
}

}  // namespace dcem::program
