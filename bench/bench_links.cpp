/// Times the exact search for links in a city, step by step.
///
///   bench_links ROUNDS FILE.obj|FILE.json --mast X Y Z [--receivers N] [--within METRES] [--height METRES]
///                              [--copies N | --frame N] [--interactions N] [--diffractions N] [--roofs]
///                              [--no-lists | --over-edges] [--threads N]
///
/// Of a scenario the scene is taken with its bodies where they are in a frame. Receivers stand at random where nothing
/// is above them but the sky, in streets or on roofs, the transmitter at a mast. For each link: what the receiver may
/// see (its half), its half joined with that of the mast, and the solver. One CSV row for each step: mean, 95 % and the
/// longest of all links, medians over the rounds; `elapsed_ms` is what passes on the clock for all links, by link:
/// with more threads than one it is less than the mean. Rounds must find the same paths: otherwise exit 1.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/bench_program.hpp"
#include "bench/result_hash.hpp"
#include "bench/tiled_mesh.hpp"
#include "dcem/accel/wide_index.hpp"
#include "dcem/core/random.hpp"
#include "dcem/core/statistics.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/io/frame_source.hpp"
#include "dcem/io/obj_reader.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/paths/halves/link_halves.hpp"
#include "dcem/paths/path_finder.hpp"

namespace {

using dcem::Vec3;
using dcem::bench::Stopwatch;

struct Options {
  int rounds = 1;
  std::string file;
  std::vector<double> mast_m;
  std::size_t receivers = 100;
  double within_m = 280.0, height_m = 1.5;
  int copies = 1, interactions = 2, diffractions = 1;
  std::size_t frame = 0;
  unsigned threads = 1;
  bool roofs = false, no_lists = false, over_edges = false;
};

constexpr const char* step_names[] = {"half", "join", "solver", "sum"};
constexpr std::size_t step_count = 4;

/// One link, step by step, in milliseconds, and what was done.
struct LinkTimes {
  std::array<double, step_count> ms{};
  std::size_t mirrors = 0, edges = 0, proposed = 0, paths = 0;
  std::vector<std::array<std::uint64_t, 2>> path_facts;  ///< how many interactions, and the bits of the length
};

/// That of a scenario in a frame, or copies of an OBJ file side by side.
dcem::Scene scene_of(const Options& options) {
  if (std::filesystem::path(options.file).extension() == ".json") {
    dcem::io::Scenario scenario = dcem::io::load_scenario(options.file);
    dcem::io::FrameSource frames(scenario);
    for (std::size_t index = 0; index <= options.frame; ++index)
      scenario.scene.apply(frames.frame(scenario.scene, index));
    return std::move(scenario.scene);
  }
  dcem::Scene scene;
  const dcem::TriangleMesh mesh = dcem::bench::tiled(dcem::io::read_obj(options.file).mesh, options.copies);
  for (const std::string& name : mesh.material_names) scene.add_material({name, dcem::PerfectConductor{}});
  scene.set_scenery(mesh);
  return scene;
}

class City {
 public:
  explicit City(const Options& options) : options_(options), scene_(scene_of(options)), rooms_(options.threads) {
    index_.build(scene_.triangle_view(), scene_.triangle_boxes(), scene_.first_triangles());
    outlines_.emplace(scene_);
    lanes_.emplace(scene_, *outlines_);
    search_.exhaustive = false;
    search_.max_reflections = std::min(2, options.interactions);
    search_.max_transmissions = 0;
    search_.max_diffractions = options.diffractions;
    search_.max_interactions = options.interactions;
    search_.joined = 3;
  }

  const dcem::Scene& scene() const { return scene_; }

  /// The mast's half and, where they are wanted, its lists; milliseconds.
  double look_from_mast() {
    const Stopwatch watch;
    mast_.position_m = {options_.mast_m[0], options_.mast_m[1], options_.mast_m[2]};
    const bool triples = dcem::joins_triples(search_);
    constexpr std::size_t very_many = 1'000'000;  // links: lists over edges come for all edges at once
    dcem::HalfLists lists{&*lanes_, options_.interactions >= 2, !options_.no_lists || triples,
                          options_.over_edges ? very_many : 1, nullptr};
    halves_[0].update(scene_, *outlines_, mast_, dcem::half_settings(search_), lists);
    return watch.elapsed_ms();
  }

  /// Places under the open sky, so high over what is below them.
  std::vector<Vec3> receivers() const {
    dcem::Aabb<double> bounds;
    for (const Vec3& vertex : scene_.vertices_m()) bounds.extend(vertex);
    std::vector<Vec3> places;
    dcem::RandomStream random(7);
    while (places.size() < options_.receivers) {
      const Vec3 above(options_.mast_m[0] + options_.within_m * (2.0 * random.uniform() - 1.0),
                       options_.mast_m[1] + options_.within_m * (2.0 * random.uniform() - 1.0), bounds.max.z + 1.0);
      const auto ground = index_.closest_hit({above, Vec3(0.0, 0.0, -1.0)}, {}, nullptr);
      if (!ground) continue;
      const double over_lowest_m = above.z - ground->t - bounds.min.z;
      const bool is_asked_for = options_.roofs ? over_lowest_m > 3.0 : over_lowest_m < 0.5;
      if (is_asked_for) places.push_back({above.x, above.y, above.z - ground->t + options_.height_m});
    }
    return places;
  }

  LinkTimes solve(const Vec3& receiver_m, unsigned worker) {
    dcem::ReceiverRoom& room = rooms_[worker];
    const dcem::SceneTracer<dcem::WideIndex> tracer(scene_, index_);
    const dcem::LinkEnd receiver{receiver_m, {}, {}};
    const std::vector<std::optional<dcem::LinkEnd>> transmitters{mast_};
    LinkTimes times;
    const Stopwatch half;
    dcem::look_from(scene_, search_, *outlines_, *lanes_, receiver, room);
    times.ms[0] = half.elapsed_ms();
    const dcem::HalfRefs masts{halves_};
    const Stopwatch join;
    const auto proposed =
        dcem::join_halves(scene_, search_, {*outlines_, *lanes_, masts, room.half, room.lists}, transmitters);
    times.ms[1] = join.elapsed_ms();
    const Stopwatch solver;
    dcem::SearchCounters counters;
    const auto links = dcem::find_paths(tracer, search_, receiver, {"", 0}, transmitters, counters, nullptr,
                                        std::vector<dcem::ReachedEdges>(1), proposed);
    times.ms[2] = solver.elapsed_ms();
    times.ms[3] = times.ms[0] + times.ms[1] + times.ms[2];
    for (const auto& layer : room.half.layers()) {
      times.mirrors += layer.mirrors.size();
      times.edges += layer.edges.size();
    }
    times.proposed = proposed[0].size();
    times.paths = links[0].paths.size();
    for (const dcem::Path& path : links[0].paths) {
      times.path_facts.push_back({path.interactions.size(), dcem::bench::hash_of(path.length_m)});
    }
    return times;
  }

 private:
  const Options& options_;
  dcem::Scene scene_;
  dcem::WideIndex index_;
  std::optional<dcem::FacetOutlines> outlines_;
  std::optional<dcem::LaneScene> lanes_;
  dcem::PathSearchSettings search_;
  std::vector<dcem::KeptHalf> halves_{dcem::KeptHalf(512)};
  dcem::LinkEnd mast_;
  std::vector<dcem::ReceiverRoom> rooms_;
};

bool bench(const Options& options) {
  City city(options);
  const double mast_ms = city.look_from_mast();
  const std::vector<Vec3> places = city.receivers();
  std::array<std::vector<std::vector<double>>, step_count> by_link;  // step, link, round
  for (auto& step : by_link) step.resize(places.size());
  std::uint64_t expected = 0;
  LinkTimes sum;
  dcem::ThreadPool pool(options.threads);
  std::vector<double> elapsed_ms;
  for (int round = 0; round < options.rounds; ++round) {
    std::uint64_t hash = 0;
    sum = {};
    std::vector<LinkTimes> times_of(places.size());
    const Stopwatch watch;
    pool.for_each(places.size(),
                  [&](std::size_t link, unsigned worker) { times_of[link] = city.solve(places[link], worker); });
    elapsed_ms.push_back(watch.elapsed_ms() / static_cast<double>(places.size()));
    for (std::size_t link = 0; link < places.size(); ++link) {
      const LinkTimes& times = times_of[link];
      for (const auto& [interactions, length] : times.path_facts) hash = dcem::hash_values(hash, interactions, length);
      for (std::size_t step = 0; step < step_count; ++step) by_link[step][link].push_back(times.ms[step]);
      sum.mirrors += times.mirrors;
      sum.edges += times.edges;
      sum.proposed += times.proposed;
      sum.paths += times.paths;
    }
    if (round > 0 && hash != expected) {
      std::fputs("paths differ between rounds\n", stderr);
      return false;
    }
    expected = hash;
  }
  for (std::size_t step = 0; step < step_count; ++step) {
    std::vector<double> ms;
    double mean_ms = 0.0;
    for (const std::vector<double>& of_link : by_link[step]) {
      ms.push_back(dcem::median(of_link));
      mean_ms += ms.back() / static_cast<double>(places.size());
    }
    dcem::bench::CsvRow row;
    row.text(std::filesystem::path(options.file).stem().string()).count(city.scene().triangles().size());
    row.count(static_cast<std::size_t>(options.interactions)).count(static_cast<std::size_t>(options.diffractions));
    row.text(options.no_lists     ? "no"
             : options.over_edges ? "over edges"
                                  : "yes")
        .text(options.roofs ? "roofs" : "streets")
        .count(places.size())
        .number(mast_ms, 1)
        .text(step_names[step]);
    row.number(mean_ms, 3).number(dcem::quantile(ms, 0.95), 3).number(dcem::quantile(ms, 1.0), 3);
    row.count(sum.mirrors).count(sum.edges).count(sum.proposed).count(sum.paths).hash(expected);
    row.count(options.threads).number(dcem::median(elapsed_ms), 3).print();
  }
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  CLI::App app("Times the exact search for links in a city");
  app.add_option("ROUNDS", options.rounds, "rounds over all links")->required()->check(CLI::Range(1, 1000));
  app.add_option("FILE", options.file, "OBJ file, in metres, z up, or scenario")->required();
  app.add_option("--mast", options.mast_m, "where the transmitter stands")->required()->expected(3);
  app.add_option("--receivers", options.receivers, "how many")->check(CLI::Range(1, 1'000'000));
  app.add_option("--within", options.within_m, "of the mast, along both axes, m")->check(CLI::PositiveNumber);
  app.add_option("--height", options.height_m, "of the receivers over the ground, m");
  auto* const copies = app.add_option("--copies", options.copies, "N x N copies of an OBJ file");
  copies->check(CLI::Range(1, 16));
  app.add_option("--frame", options.frame, "of the scenario")->excludes(copies);
  app.add_option("--threads", options.threads, "links are shared out to")->check(CLI::Range(1, 256));
  app.add_option("--interactions", options.interactions, "at most")->check(CLI::Range(0, 3));
  app.add_option("--diffractions", options.diffractions, "at most")->check(CLI::Range(0, 2));
  app.add_flag("--roofs", options.roofs, "receivers stand on roofs instead of in streets");
  auto* const no_lists = app.add_flag("--no-lists", options.no_lists, "the mast has not stood for long");
  app.add_flag("--over-edges", options.over_edges, "the mast has stood for thousands of links")->excludes(no_lists);
  return dcem::bench::run_program(app, count, arguments, [&] {
    std::puts(
        "scene,triangles,max_interactions,max_diffractions,lists,receivers,links,mast_ms,step,mean_ms,p95_ms,maximum_"
        "ms,mirrors,"
        "edges,proposed,paths,hash,threads,elapsed_ms");
    return bench(options);
  });
}
