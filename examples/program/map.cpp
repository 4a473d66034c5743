/// `dcem map`: a coverage map per grid or list of points, transmitter and frame, and what all transmitters together do.
#include <algorithm>
#include <chrono>
#include <iostream>
#include <set>

#include "dcem/channel/map_combination.hpp"
#include "dcem/channel/thermal_noise.hpp"
#include "dcem/io/frame_source.hpp"
#include "dcem/io/input_error.hpp"
#include "dcem/io/map_writer.hpp"
#include "dcem/io/placement_watch.hpp"
#include "dcem/io/sampling_text.hpp"
#include "dcem/io/shelter.hpp"
#include "dcem/io/slow_map.hpp"
#include "frequencies.hpp"
#include "job.hpp"
#include "map_files.hpp"
#include "stop_signal.hpp"

namespace dcem::program {
namespace {

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
  /// A receiver in the midst of the first of them.
  std::optional<Device> middle() const {
    if (!grids.empty()) return grid_receiver(grids.front(), grids.front().rows() / 2, grids.front().columns() / 2);
    if (lists.empty() || lists.front().receivers.empty()) return std::nullopt;
    return lists.front().receivers[lists.front().receivers.size() / 2];
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

/// While a map is folded to cells there are both. The maps of a frame are there together, and while they are written
/// what is over all transmitters is, too.
void check_memory(const Scene& scene, const MapOrders& orders, const ScenarioOptions& options) {
  const double point_bytes =
      static_cast<double>(scene.transmitters().size()) * sizeof(RadioMapPoint) + sizeof(CombinedMapPoint);
  for (const ReceiverGrid& grid : orders.grids) {
    const std::size_t samples = grid.samples_per_cell();
    const std::size_t points = grid.size() * (samples > 1 ? samples + 1 : 1);
    require_memory(options, points_text("grid", grid.id, points), points, point_bytes);
  }
  for (const ReceiverList& list : orders.lists) {
    const std::size_t points = list.receivers.size();
    require_memory(options, points_text("list", list.id, points), points, point_bytes);
  }
  require_memory(options, std::to_string(orders.points()) + " points of the maps of a frame", orders.points(),
                 point_bytes);
}

void check_orders(const Scene& scene, const MapOrders& orders, const ScenarioOptions& options) {
  if (orders.points() == 0) {
    throw io::InputError(options.scenario,
                         "no receiver is a grid or a list of points; expected one with the key 'grid', 'positions_m' "
                         "or 'points_csv' to make a map of");
  }
  check_names(scene, orders, options.scenario);
  check_memory(scene, orders, options);
}

void add_figures(const RadioMap& map, io::FrameFigures& figures) {
  for (const RadioMapPoint& point : map.points) {
    if (point.obstructed) continue;
    ++figures.links;
    figures.links_with_line_of_sight += point.statistics.line_of_sight ? 1U : 0U;
    figures.paths += point.statistics.path_count;
  }
}

/// Thrown out of the midst of a map when it is to end.
struct StopNow {};

/// The maps of one frame. None is written before all are there.
struct FrameMaps {
  FrameResult result;
  io::FrameFigures figures;
  std::vector<std::vector<RadioMap>> maps;  ///< by grid or list, then by transmitter
};

/// The links of a frame's own receivers. Where there are none but those of maps, which look for themselves, nobody
/// looks from the transmitters in vain.
FrameResult advanced(Simulator& simulator, const Frame& frame) {
  if (!simulator.scene().receivers().empty()) return simulator.advance(frame);
  FrameResult result{frame.index, frame.time_s, {}, {}, {}, {}, 0.0, 0.0};
  const auto start = std::chrono::steady_clock::now();
  result.tree = simulator.move_to(frame);
  result.update_time_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

/// Nothing where a signal came before all points were done.
std::optional<FrameMaps> solve_maps(const MapOrders& orders, Simulator& simulator, const Frame& frame,
                                    io::ProgressBar& bar, const StopRequest& stop) {
  FrameMaps solved{advanced(simulator, frame), {}, {}};
  solved.figures = io::figures_of(solved.result);
  const auto tell = [&](std::size_t points) {
    if (stop.signal() != 0) throw StopNow{};
    bar.advance(points);
  };
  const auto make = [&](const auto& places) {
    const auto start = std::chrono::steady_clock::now();
    solved.maps.push_back(simulator.radio_maps(places, tell, &solved.figures.work));
    io::mark_sheltered(simulator, frame, solved.maps.back());
    solved.figures.solve_time_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const RadioMap& map : solved.maps.back()) add_figures(map, solved.figures);
  };
  try {
    for (const ReceiverGrid& grid : orders.grids) make(grid);
    for (const ReceiverList& list : orders.lists) make(list);
  } catch (const StopNow&) {
    return std::nullopt;
  }
  return solved;
}

Device receiver_at(const ReceiverGrid& grid, std::size_t point) {
  return grid_receiver(grid, point / grid.columns(), point % grid.columns());
}
Device receiver_at(const ReceiverList& list, std::size_t point) {
  return list.receivers[point];
}

/// What rays lack at some of the points of a map.
template <typename Places>
SamplingReport check_points(const Simulator& simulator, const Frame& frame, const Places& places, const RadioMap& map) {
  // One in a hundred, so that it takes no longer than the map; no more links than an exact search is for.
  constexpr std::size_t few_points = 16, many_links = 64;
  const std::size_t transmitters = std::max<std::size_t>(1, simulator.scene().transmitters().size());
  const std::size_t many_points = std::max(few_points, many_links / transmitters);
  std::vector<std::size_t> open;
  for (std::size_t point = 0; point < map.points.size(); ++point) {
    if (!map.points[point].obstructed) open.push_back(point);
  }
  const std::size_t most_points = std::clamp(open.size() / 100, few_points, many_points);
  const std::size_t count = std::min(most_points, open.size());
  std::vector<Device> receivers;
  for (std::size_t number = 0; number < count; ++number) {
    receivers.push_back(receiver_at(places, open[number * open.size() / count]));
  }
  WorkCounters work;
  const std::vector<LinkResult> links = simulator.solve(receivers, &work);
  return check_sampling(simulator, frame, {receivers, links, work.sequences_proposed}, most_points);
}

/// The same of the first map of a frame that has a point to look at.
SamplingReport check_maps(const Simulator& simulator, const Frame& frame, const MapOrders& orders,
                          const FrameMaps& solved) {
  SamplingReport report;
  if (simulator.discovery() == Discovery::exact) return report;
  std::size_t number = 0;
  const auto check = [&](const auto& places) {
    const std::vector<RadioMap>& maps = solved.maps[number++];
    if (report.links.empty() && !maps.empty()) report = check_points(simulator, frame, places, maps.front());
  };
  for (const ReceiverGrid& grid : orders.grids) check(grid);
  for (const ReceiverList& list : orders.lists) check(list);
  return report;
}

void write_maps(const FrameMaps& solved, io::OutputFolder& folder, const Job& job, const Simulator& simulator,
                const Frame& frame, io::ViewerWriter* viewer, const std::optional<io::ValueRange>& range_dbm,
                const std::vector<std::string>& notes) {
  if (viewer != nullptr) viewer->add(frame, solved.result);
  std::optional<double> noise_dbm;
  if (job.scenario.noise) noise_dbm = noise_power_dbm(*job.scenario.noise);
  for (const std::vector<RadioMap>& maps : solved.maps) {
    if (maps.empty()) continue;
    const CombinedMap combined = combine_maps(maps, noise_dbm);
    if (viewer != nullptr) viewer->add(maps, combined, noise_dbm.has_value());
    MapFiles(folder, job, simulator, frame, range_dbm, notes).write(maps, combined);
  }
}

/// Makes the maps frame by frame until a signal comes; returns the first frame that is not there.
std::size_t map_frames(const Job& job, const ScenarioOptions& options, const MapOrders& orders, Simulator& simulator,
                       io::OutputFolder& folder, io::ViewerWriter* viewer, io::RunSummary& summary,
                       io::PlacementWatch& watch, const StopRequest& stop) {
  io::FrameSource frames(job.scenario);
  io::ProgressBar bar("points", orders.points() * job.frames.count(), progress_mode(options));
  std::optional<Frame> last;
  std::optional<SamplingReport> sampling;
  std::optional<io::ValueRange> range_dbm = job.scenario.output.map_pictures.range_dbm;
  for (std::size_t index = job.frames.first; index < job.frames.last; ++index) {
    const Frame frame = frames.frame(simulator.scene(), index);
    const std::optional<FrameMaps> solved =
        stop.signal() == 0 ? solve_maps(orders, simulator, frame, bar, stop) : std::nullopt;
    if (!solved) {
      if (last) simulator.move_to(*last);  // the summary tells of the scene as it stood in the last whole frame
      return index;
    }
    watch.look(frame);
    if (!sampling) sampling = check_maps(simulator, frame, orders, *solved);
    range_dbm = shared_range_dbm(range_dbm, solved->maps);
    write_maps(*solved, folder, job, simulator, frame, viewer, range_dbm, io::sampling_notes(*sampling));
    summary.add(solved->figures);
    summary.set_sampling(*sampling);
    last = frame;
  }
  return job.frames.last;
}

/// In the order of the enumeration.
void add_format(io::PictureFormat format, std::vector<io::PictureFormat>& formats) {
  if (!io::can_draw() && format != io::PictureFormat::png) {
    throw UsageError("--output " + std::string(io::word_of(format)) + ": " + std::string(io::no_drawing),
                     std::string(io::drawing_expected));
  }
  formats.push_back(format);
  std::sort(formats.begin(), formats.end());
}

/// `dcem map --output csv,png,html`: which files of each map are wanted, and whether the page is. All words are known.
void choose_outputs(const std::string& list, io::OutputSettings& output) {
  output.map = {false, false, false, std::vector<io::PictureFormat>{}};
  output.html = false;
  const std::vector<std::pair<std::string, bool*>> kinds{{"csv", &output.map.csv},
                                                         {"npz", &output.map.npz},
                                                         {"asc", &output.map.asc},
                                                         {"html", &output.html},
                                                         {"kml", &output.map.kml}};
  for (const std::string& word : words_of(list)) {
    const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const auto& one) { return one.first == word; });
    if (kind != kinds.end()) {
      *kind->second = true;
    } else {
      add_format(io::picture_format(word).value(), *output.map.pictures);
    }
  }
  if (output.html && !io::viewer_is_built_in()) {
    throw UsageError("--output html: this build has no viewer", "three.js (libjs-three) when DCEM was built");
  }
}

std::vector<Device> listed_points(const std::vector<ReceiverList>& lists) {
  std::vector<Device> points;
  for (const ReceiverList& list : lists) points.insert(points.end(), list.receivers.begin(), list.receivers.end());
  return points;
}

/// Rasters, and pictures but for the distribution, are of grids alone.
void require_files(const MapOrders& orders, const io::OutputSettings& output) {
  const io::MapOutputs& map = output.map;
  const bool has_charts = io::can_draw() && !io::formats_or(map.pictures, io::PictureFormat::svg).empty();
  if (!orders.grids.empty() || map.csv || map.npz || has_charts || output.html) return;
  throw UsageError("--output has no effect: asc and kml are of grids, and the scenario has lists of points alone",
                   "some of csv, npz, png, svg, pdf and html");
}

/// What a build without Cairo leaves out.
void warn_of_plain_pictures(Job& job) {
  if (io::can_draw() || io::formats_or(job.scenario.output.map.pictures, io::PictureFormat::png).empty()) return;
  job.scenario.warnings.push_back("output.map: " + std::string(io::no_drawing) +
                                  "; maps are plain rasters without axes and text, and there is no distribution (" +
                                  std::string(io::drawing_expected) + " brings them)");
}

[[noreturn]] void end_interrupted(int signal, const Job& job, std::size_t next_frame) {
  const std::string by = "interrupted by " + signal_name(signal);
  if (next_frame == job.frames.first) {
    throw Interrupted(signal, by + " before the first frame was whole: nothing is written");
  }
  throw Interrupted(signal, by + ": " + job.folder.string() + " holds the maps of frames " +
                                std::to_string(job.frames.first) + " to " + std::to_string(next_frame - 1) + " of " +
                                std::to_string(job.frames.first) + " to " + std::to_string(job.frames.last - 1));
}

/// Of one frequency.
void map_one(const ScenarioOptions& options) {
  Job job = prepare_job(options);
  if (options.map_output) choose_outputs(*options.map_output, job.scenario.output);
  if (job.scenario.output.map.kml && !job.scenario.geo) {
    throw UsageError("--output kml: the scene has no place on the Earth", "the block geo in the scenario");
  }
  const std::vector<ReceiverList> lists = io::take_point_lists(job.scenario);
  const MapOrders orders{job.scenario.grids, lists};
  check_orders(job.scenario.scene, orders, options);
  if (options.map_output) require_files(orders, job.scenario.output);
  Simulator simulator = make_simulator(job, options);
  require_effect(options, simulator);
  ResultFolder folder(job.folder, job.scenario.name, "map_summary.json", "summary.json");
  if (job.scenario.output.html) folder.require_free("viewer.html");
  warn_of_plain_pictures(job);
  if (const auto hint = io::slow_map_hint(simulator.settings().propagation, simulator.plan(),
                                          simulator.scene().surface_count(), orders.points())) {
    job.scenario.warnings.push_back(*hint);
  }
  if (const auto receiver = orders.middle())
    warn_of_slow_search(job, simulator, *receiver, orders.points() * simulator.scene().transmitters().size());
  io::RunSummary summary(run_facts(job, simulator, simulator.plan(), orders.points()), simulator.scene());
  print_warnings(job.scenario.warnings, options);
  // The powers, the best server and the SINR.
  const std::size_t values_per_cell = simulator.scene().transmitters().size() + 2;
  const auto viewer = make_viewer(folder.files(), job, simulator, orders.cells() * values_per_cell);
  const StopRequest stop;
  const std::vector<Device> listed = listed_points(lists);
  io::PlacementWatch watch(options.scenario, simulator, listed, job.scenario.grids, io::PlacementWatch::Links::all);
  const WorkTimes begun = work_times();
  const std::size_t next_frame =
      map_frames(job, options, orders, simulator, folder.files(), viewer.get(), summary, watch, stop);
  for (const std::string& line : watch.warnings()) summary.add_late_warning(line);
  const bool is_cut = next_frame < job.frames.last;
  if (is_cut && next_frame == job.frames.first) end_interrupted(stop.signal(), job, next_frame);
  if (is_cut) summary.set_interruption({signal_name(stop.signal()), next_frame, job.frames.last});
  {
    const io::ProgressStage stage("writing results", progress_mode(options));
    finish_viewer(viewer.get(), summary, io::sampling_notes(summary.sampling()));
    summary.set_work_times(work_times() - begun);
    folder.commit(summary, run_identity(job, options).text());
  }
  print_warnings(summary.late_warnings(), options);
  if (!options.quiet) std::cout << summary.table(job.folder) << std::flush;
  if (is_cut) end_interrupted(stop.signal(), job, next_frame);
}

}  // namespace

void map_scenario(const ScenarioOptions& options) {
  for (const ScenarioOptions& one : by_frequency(options)) map_one(one);
}

}  // namespace dcem::program
