/// `dcem map`: a coverage map per grid or list of points, transmitter and frame, and what all transmitters together do.
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
#include "dcem/io/placement_watch.hpp"
#include "dcem/io/sampling_text.hpp"
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

/// What maps are asked of: grids, and lists of points.
struct MapOrders {
  const std::vector<ReceiverGrid>& grids;
  const std::vector<ReceiverList>& lists;

  /// Points that are computed, samples of cells among them.
  std::size_t points() const {
    std::size_t sum = 0;
    for (const ReceiverGrid& grid : grids) sum += grid.size() * grid.samples_per_cell();
    for (const ReceiverList& list : lists) sum += list.receivers.size();
    return sum;
  }
  std::size_t cells() const {
    std::size_t sum = 0;
    for (const ReceiverGrid& grid : grids) sum += grid.size();
    return sum;
  }
  /// `visit(id, "grid 'id'")`, or with "list".
  template <typename Visit>
  void for_each(Visit&& visit) const {
    for (const ReceiverGrid& grid : grids) visit(grid.id, "grid '" + grid.id + "'");
    for (const ReceiverList& list : lists) visit(list.id, "list '" + list.id + "'");
  }
};

// Two ids may differ in a way that their file names do not, as in grids "a" and "a_b" with transmitters "b_c" and "c".
// The names of what is over all transmitters are taken as well.
void check_names(const Scene& scene, const MapOrders& orders, const std::string& file) {
  std::set<std::string> names;
  const auto take = [&](const std::string& id, const std::string& what, const std::string& kind,
                        const std::string& part) {
    const std::string name = io::map_name(id, part, {});
    if (names.insert(name).second) return;
    throw io::InputError(file, what + " and " + kind + "'" + part + "' give the file name '" + name +
                                   "' a second time; expected ids that keep the names apart");
  };
  orders.for_each([&](const std::string& id, const std::string& what) {
    for (const char* part : {best_server_part, sinr_part, distribution_part}) take(id, what, "", part);
  });
  orders.for_each([&](const std::string& id, const std::string& what) {
    for (const Device& transmitter : scene.transmitters()) take(id, what, "transmitter ", transmitter.id);
  });
}

/// While a map is folded to cells there are both.
void check_memory(const Scene& scene, const MapOrders& orders, const std::string& file) {
  const double point_bytes = static_cast<double>(scene.transmitters().size()) * sizeof(RadioMapPoint);
  for (const ReceiverGrid& grid : orders.grids) {
    const std::size_t samples = grid.samples_per_cell();
    require_memory(file, "grid '" + grid.id + "'", grid.size() * (samples > 1 ? samples + 1 : 1), point_bytes);
  }
  for (const ReceiverList& list : orders.lists) {
    require_memory(file, "list '" + list.id + "'", list.receivers.size(), point_bytes);
  }
}

void add_figures(const RadioMap& map, io::FrameFigures& figures) {
  for (const RadioMapPoint& point : map.points) {
    if (point.obstructed) continue;
    ++figures.links;
    figures.links_with_line_of_sight += point.statistics.line_of_sight ? 1U : 0U;
    figures.paths += point.statistics.path_count;
  }
}

/// Writes the files of the maps of one frame. Pictures and rasters are of grids alone.
class MapFiles {
 public:
  /// `notes` stand at the foot of each picture.
  MapFiles(io::OutputFolder& folder, const Job& job, const Simulator& simulator, const Frame& frame,
           std::vector<std::string> notes)
      : folder_(folder),
        notes_(std::move(notes)),
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
    return io::map_name(map.places.id(), part, number_);
  }

  void write_one(const RadioMap& map) {
    const std::string name = io::map_name(map.places.id(), map.transmitter, number_);
    if (wanted_.csv) put(name + ".csv", [&](auto& file) { io::write_map_csv(file, map, frequency_hz_); });
    if (wanted_.npz) put(name + ".npz", [&](auto& file) { io::write_map_npz(file, map, frequency_hz_); });
    if (wanted_.asc && map.places.is_grid()) put(name + ".asc", [&](auto& file) { io::write_map_asc(file, map); });
    const auto draw = [&](auto& file) {
      io::write_heat_map_png(noted(io::map_picture(map, scene_, frame_, frequency_hz_, time_s_)), file);
    };
    if (wanted_.png && map.places.is_grid()) put(name + ".png", draw);
  }

  void write_best_server(const CombinedMap& map) {
    const std::string name = name_of(map, best_server_part);
    if (wanted_.csv) put(name + ".csv", [&](auto& file) { io::write_best_server_csv(file, map); });
    if (wanted_.npz) put(name + ".npz", [&](auto& file) { io::write_best_server_npz(file, map); });
    if (wanted_.asc && map.places.is_grid())
      put(name + ".asc", [&](auto& file) { io::write_best_server_asc(file, map); });
    const auto draw = [&](auto& file) {
      io::write_heat_map_png(noted(io::best_server_picture(map, scene_, frame_, frequency_hz_, time_s_)), file);
    };
    if (wanted_.png && map.places.is_grid()) put(name + ".png", draw);
  }

  void write_sinr(const CombinedMap& map) {
    const std::string name = name_of(map, sinr_part);
    if (wanted_.csv) put(name + ".csv", [&](auto& file) { io::write_sinr_csv(file, map); });
    if (wanted_.npz) put(name + ".npz", [&](auto& file) { io::write_sinr_npz(file, map); });
    if (wanted_.asc && map.places.is_grid()) put(name + ".asc", [&](auto& file) { io::write_sinr_asc(file, map); });
    const auto draw = [&](auto& file) {
      const bool has_noise = noise_dbm_.has_value();
      io::write_heat_map_png(noted(io::sinr_picture(map, scene_, frame_, frequency_hz_, has_noise, time_s_)), file);
    };
    if (wanted_.png && map.places.is_grid()) put(name + ".png", draw);
  }

  /// A picture that says what must be known of its values.
  io::HeatMap noted(io::HeatMap picture) const {
    picture.notes = notes_;
    return picture;
  }

  io::OutputFolder& folder_;
  const std::vector<std::string> notes_;
  const io::MapOutputs wanted_;
  const Scene& scene_;
  const Frame& frame_;
  const std::optional<std::size_t> number_;  ///< in the names of files; absent where there is one frame
  const std::optional<double> time_s_;
  const double frequency_hz_;
  std::optional<double> noise_dbm_;
};

Device receiver_at(const ReceiverGrid& grid, std::size_t point) {
  return grid_receiver(grid, point / grid.columns(), point % grid.columns());
}
Device receiver_at(const ReceiverList& list, std::size_t point) {
  return list.receivers[point];
}

/// What rays lack at some of the points of a map.
template <typename Places>
SamplingReport check_points(const Simulator& simulator, const Frame& frame, const Places& places, const RadioMap& map) {
  constexpr std::size_t most_points = 16;
  if (simulator.discovery() == Discovery::exact) return {};
  std::vector<std::size_t> open;
  for (std::size_t point = 0; point < map.points.size(); ++point) {
    if (!map.points[point].obstructed) open.push_back(point);
  }
  std::vector<Device> receivers;
  for (std::size_t number = 0; number < std::min(most_points, open.size()); ++number) {
    receivers.push_back(receiver_at(places, open[number * open.size() / std::min(most_points, open.size())]));
  }
  return check_sampling(simulator, frame, receivers, simulator.solve(receivers), most_points);
}

io::FrameFigures map_frame(io::OutputFolder& folder, const Job& job, const MapOrders& orders, Simulator& simulator,
                           const Frame& frame, io::ViewerWriter* viewer, io::ProgressBar& bar,
                           std::optional<SamplingReport>& sampling) {
  const FrameResult result = simulator.advance(frame);
  io::FrameFigures figures = io::figures_of(result);
  if (viewer != nullptr) viewer->add(frame, result);
  const auto make = [&](const auto& places) {
    const auto start = std::chrono::steady_clock::now();
    const auto maps = simulator.radio_maps(
        places, [&](std::size_t points) { bar.advance(points); }, &figures.work);
    figures.solve_time_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const RadioMap& map : maps) {
      add_figures(map, figures);
      if (viewer != nullptr && map.places.is_grid()) viewer->add(map);
    }
    if (!sampling && !maps.empty()) sampling = check_points(simulator, frame, places, maps.front());
    MapFiles(folder, job, simulator, frame, sampling ? io::sampling_notes(*sampling) : std::vector<std::string>{})
        .write(maps);
  };
  for (const ReceiverGrid& grid : orders.grids) make(grid);
  for (const ReceiverList& list : orders.lists) make(list);
  return figures;
}

}  // namespace

void map_scenario(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  const std::vector<ReceiverList> lists = io::take_point_lists(job.scenario);
  const MapOrders orders{job.scenario.grids, lists};
  if (orders.points() == 0) {
    throw io::InputError(
        options.scenario,
        "no receiver is a grid or a list of points; expected one with the key 'grid', 'positions_m' or "
        "'points_csv' to make a map of");
  }
  check_names(job.scenario.scene, orders, options.scenario);
  check_memory(job.scenario.scene, orders, options.scenario);
  io::FrameSource frames(job.scenario);
  Simulator simulator = make_simulator(job, options);
  io::OutputFolder folder(job.folder);
  const std::size_t points = orders.points();
  io::RunSummary summary(run_facts(job, simulator, simulator.plan(), points), simulator.scene());
  print_warnings(job.scenario.warnings, options);
  const auto viewer = make_viewer(folder, job, simulator, orders.cells() * simulator.scene().transmitters().size());
  std::vector<Device> points_of_lists;
  for (const ReceiverList& list : lists) {
    points_of_lists.insert(points_of_lists.end(), list.receivers.begin(), list.receivers.end());
  }
  io::PlacementWatch watch(options.scenario, simulator, points_of_lists, job.scenario.grids);
  std::optional<SamplingReport> sampling;  // of the first map
  {
    io::ProgressBar bar("points", points * job.frames.count(), progress_mode(options));
    for (std::size_t frame = job.frames.first; frame < job.frames.last; ++frame) {
      const Frame instant = frames.frame(simulator.scene(), frame);
      const io::FrameFigures figures = map_frame(folder, job, orders, simulator, instant, viewer.get(), bar, sampling);
      watch.look(instant);
      summary.add(figures);
    }
  }
  if (sampling) summary.set_sampling(*sampling);
  for (const std::string& warning : watch.warnings()) summary.add_late_warning(warning);
  finish_viewer(viewer.get(), summary);
  folder.open("map_summary.json").write(summary.json());
  folder.commit();
  print_warnings(summary.late_warnings(), options);
  if (!options.quiet) std::cout << summary.table(folder.path());
}

}  // namespace dcem::program
