/// `dcem map`: a coverage map per grid, transmitter and frame.
#include <chrono>
#include <iostream>
#include <set>

#include "dcem/io/frame_source.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/map_writer.hpp"
#include "program_job.hpp"

namespace dcem::program {
namespace {

/// One frame's number for the file names, or nothing where there is only one frame.
std::optional<std::size_t> numbered(const Job& job, std::size_t frame) {
  return job.frames.count() > 1 ? std::optional(frame) : std::nullopt;
}

// Two ids may differ in a way that their file names do not, as in grids "a" and "a_b" with transmitters "b_c" and "c".
void check_names(const Job& job, const std::string& file) {
  std::set<std::string> names;
  for (const ReceiverGrid& grid : job.scenario.grids) {
    for (const Device& transmitter : job.scenario.scene.transmitters()) {
      const std::string name = io::map_name(grid.id, transmitter.id, {});
      if (names.insert(name).second) continue;
      throw io::InputError(file, "grid '" + grid.id + "' and transmitter '" + transmitter.id +
                                     "' give the file name '" + name +
                                     "' a second time; expected ids that keep the names apart");
    }
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

void write_map(io::OutputFolder& folder, const RadioMap& map, const Job& job, const Simulator<>& simulator,
               const Frame& frame) {
  const std::optional<std::size_t> number = numbered(job, frame.index);
  const std::string name = io::map_name(map.grid.id, map.transmitter, number);
  const double frequency_hz = simulator.settings().frequency_hz;
  const auto time_s = number ? std::optional(frame.time_s) : std::nullopt;
  io::AtomicFile& table = folder.open(name + ".csv");
  io::write_map_csv(table, map, frequency_hz);
  table.close();
  io::AtomicFile& picture = folder.open(name + ".png");
  io::write_heat_map_png(io::map_picture(map, simulator.scene(), frame, frequency_hz, time_s), picture);
  picture.close();
}

io::FrameFigures map_frame(io::OutputFolder& folder, const Job& job, Simulator<>& simulator, const Frame& frame,
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
      write_map(folder, map, job, simulator, frame);
      if (viewer != nullptr) viewer->add(map);
    }
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
  io::FrameSource frames(job.scenario);
  Simulator<> simulator = make_simulator(job, options);
  io::OutputFolder folder(job.folder);
  const std::size_t points = point_count(job.scenario);
  io::RunSummary summary(run_facts(job, simulator, points), simulator.scene());
  print_warnings(job, options);
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
  if (!options.quiet) std::cout << summary.table(folder.path());
}

}  // namespace dcem::program
