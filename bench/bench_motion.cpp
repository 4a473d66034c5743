/// Times a tree that follows driving cars, and rays through it: the wide tree in its ways, the binary tree, and Embree
/// in its ways where it was found.
///
///   bench_motion FILE.obj [--cars V...] [--frames N] [--rays R] [--limit GROWTH | --sweep] [--two-threads]
///                [--series FILE]
///
/// In each frame every tree in turn follows the motion and gets the same rays. Before, untimed, four times as many
/// others go through it, because in a program that has one tree the caches hold what its last rays have touched, and
/// not what a dozen other trees need. Then the same rays go through it once more: what has just been built anew is in
/// the caches already, and only when both have been used as much do two trees show how good they are. One CSV row per
/// number of cars and tree; a table that a person reads goes to standard error. The wide trees must give the same hits
/// to the last bit in every frame, and the binary tree the same to 1e-5 of the distance but for one ray in 100,000:
/// anything else is an error, exit 1. Embree's differences are counted. `--series` writes a row per frame and tree to a
/// file; bench/plot_motion.py draws it.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/bench_program.hpp"
#include "bench/moving_boxes.hpp"
#include "bench/timed_rays.hpp"
#include "dcem/accel/binary/updater.hpp"
#include "dcem/accel/wide/update/updater.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/statistics.hpp"
#include "dcem/io/atomic_file.hpp"
#if defined(DCEM_HAS_EMBREE)
#include "bench/embree_motion.hpp"
#endif

namespace {

using dcem::Ray;
using dcem::TraversalCounters;
using dcem::Vec3;
using dcem::bench::as_float;
using dcem::bench::Stopwatch;
using dcem::bench::timed;
using Rays = std::vector<Ray<double>>;

constexpr double none = std::numeric_limits<double>::infinity();

/// What a tree says of a ray: where the closest hit is, or 1 for occluded and 0 for free.
struct Answer {
  double t = none;
  std::uint32_t triangle = 0;
};
using Answers = std::vector<Answer>;

struct FrameRays {
  Rays bounces, segments;
};

/// What has moved since the last frame.
struct Moved {
  std::vector<dcem::BodyId> bodies;
  std::vector<std::uint32_t> triangles;
};

/// What an update did; zero where a tree does not say.
struct Work {
  std::uint64_t leaves = 0, nodes = 0, restructured = 0;
  // Of the last, what is what:
  std::uint64_t reinserted = 0, rotated = 0, rebuilt_in_place = 0;
  std::string rebuilt{};  ///< all `nodes` above leaves and objects, the whole `tree`, or nothing
};

/// One tree with its way of following motion.
struct Contender {
  std::string family;  ///< wide, binary or embree
  std::string policy;  ///< rebuild, refit, …
  double limit = 0.0;  ///< of growth, for reinsertion; else 0
  std::function<void(const Moved&)> prepare = [](const Moved&) {};
  std::function<Work(const Moved&)> update{};
  /// Milliseconds for all rays.
  std::function<double(const Rays&, Answers&, TraversalCounters&)> trace_closest_ms{}, trace_occluded_ms{};
  std::function<double()> sah_cost = [] { return 0.0; };
  /// Told what the frame's rays of one kind have spent.
  std::function<void(const TraversalCounters&, std::size_t rays)> note_rays = [](const TraversalCounters&,
                                                                                 std::size_t) {};

  std::vector<double> update_ms{}, closest_ms{}, occluded_ms{};  ///< of a frame
  std::vector<double> closest_again_ms{}, occluded_again_ms{};   ///< the same rays once more
  std::vector<double> closest_steps{}, occluded_steps{};         ///< nodes and leaves visited, per ray
  Work work{}, last_work{};                                      ///< of all frames, of the last one
  std::uint64_t hash = 0, differences = 0;
};

/// Gives a contender the two loops over its tree.
template <typename ClosestHit, typename Occluded>
void set_queries(Contender& contender, unsigned threads, ClosestHit closest_hit, Occluded occluded) {
  contender.trace_closest_ms = [=](const Rays& rays, Answers& answers, TraversalCounters& counters) {
    return timed(rays, answers, counters, threads, closest_hit);
  };
  contender.trace_occluded_ms = [=](const Rays& rays, Answers& answers, TraversalCounters& counters) {
    return timed(rays, answers, counters, threads, [&](const Ray<double>& ray, TraversalCounters& sum) {
      return Answer{occluded(ray, sum) ? 1.0 : 0.0};
    });
  };
}

std::shared_ptr<dcem::WideBvh> wide_tree(const dcem::Scene& scene, unsigned threads) {
  auto tree = std::make_shared<dcem::WideBvh>();
  dcem::WideBuildSettings settings;
  settings.threads = threads;
  tree->build_objects({scene.vertices_m(), scene.triangles()}, scene.triangle_boxes(), scene.first_triangles(),
                      settings);
  return tree;
}

void set_wide_queries(Contender& contender, unsigned threads, const std::shared_ptr<dcem::WideBvh>& tree) {
  set_queries(
      contender, threads,
      [tree](const Ray<double>& ray, TraversalCounters& sum) {
        const auto hit = tree->closest_hit(ray, {}, &sum);
        return hit ? Answer{hit->t, hit->triangle} : Answer{};
      },
      [tree](const Ray<double>& ray, TraversalCounters& sum) { return tree->occluded(ray, {}, &sum); });
  contender.sah_cost = [tree] { return tree->sah_cost(); };
}

enum class WidePolicy { rebuild, refit, reinsert, grown_only };

Contender wide_contender(const dcem::Scene& scene, unsigned threads, WidePolicy policy, double limit = 0.0) {
  const auto tree = wide_tree(scene, threads);
  const dcem::TriangleView mesh{scene.vertices_m(), scene.triangles()};
  Contender contender{"wide", "rebuild", limit};
  constexpr std::array names{"rebuild", "refit", "reinsert", "reinsert grown"};
  contender.policy = names[static_cast<std::size_t>(policy)];
  contender.update = [=, &scene](const Moved& moved) -> Work {
    if (policy == WidePolicy::rebuild) {
      tree->rebuild(mesh, scene.triangle_boxes());
      return {tree->arrays().leaves.size(), tree->arrays().nodes.size(), 0, 0, 0, 0, "tree"};
    }
    const dcem::WideRefitReport report = tree->refit(moved.triangles, mesh, scene.triangle_boxes());
    if (policy == WidePolicy::refit) return {report.leaves_written, report.nodes_visited};
    const std::uint32_t turn = policy == WidePolicy::reinsert ? dcem::WideBvh::default_turn_length : 0;
    const std::size_t reinserted = tree->reinsert_moved(limit, turn);
    return {report.leaves_written, report.nodes_visited, reinserted, reinserted};
  };
  set_wide_queries(contender, threads, tree);
  return contender;
}

/// The wide tree as its updater keeps it.
Contender kept_contender(const dcem::Scene& scene, unsigned threads, const char* name,
                         const dcem::WideUpdateSettings& settings) {
  const auto tree = wide_tree(scene, threads);
  const auto updater = std::make_shared<dcem::WideUpdater>(settings);
  const dcem::TriangleView mesh{scene.vertices_m(), scene.triangles()};
  Contender contender{"wide", name};
  contender.update = [=, &scene](const Moved& moved) -> Work {
    const dcem::TreeUpdateReport report = updater->update(*tree, moved.triangles, mesh, scene.triangle_boxes());
    // A report does not say of which kind the rebuild was; but of a new tree no node is refit.
    const char* rebuilt = !report.root_rebuilt ? "" : report.nodes_refit == 0 ? "tree" : "nodes";
    return {0,
            report.nodes_refit + report.nodes_rebuilt,
            report.subtrees_rebuilt + report.rotated,
            report.reinserted,
            report.rotated,
            report.rebuilt_in_place,
            rebuilt};
  };
  contender.note_rays = [=](const TraversalCounters& spent, std::size_t rays) { updater->note_rays(spent, rays); };
  set_wide_queries(contender, threads, tree);
  return contender;
}

/// Refit, and nothing that mends.
dcem::WideUpdateSettings nothing_mends() {
  dcem::WideUpdateSettings settings;
  settings.sah_growth_limit = settings.deformation_limit = settings.reinsertion_growth = none;
  settings.subtree_rebuild_price = settings.renewal_ratio = settings.rebuild_growth_limit = none;
  settings.reinsertion_turn = settings.rotations_per_node = 0;
  return settings;
}

/// The ways of the updater, each by itself, and what it does by default.
void add_kept_contenders(const dcem::Scene& scene, unsigned threads, std::vector<Contender>& all) {
  const dcem::WideUpdateSettings usual, nothing = nothing_mends();
  dcem::WideUpdateSettings rotate = nothing, deform = nothing, sah = nothing, steps = nothing;
  rotate.rotations_per_node = 1;
  deform.deformation_limit = usual.deformation_limit;
  sah.sah_growth_limit = usual.sah_growth_limit;
  steps.subtree_rebuild_price = usual.subtree_rebuild_price;
  all.push_back(kept_contender(scene, threads, "rotate", rotate));
  all.push_back(kept_contender(scene, threads, "deform", deform));
  all.push_back(kept_contender(scene, threads, "sah", sah));
  all.push_back(kept_contender(scene, threads, "steps", steps));
  all.push_back(kept_contender(scene, threads, "adaptive", usual));
}

Contender binary_contender(const dcem::Scene& scene, unsigned threads) {
  const auto tree = std::make_shared<dcem::Bvh<double>>();
  const auto updater = std::make_shared<dcem::BvhUpdater<double>>();
  tree->build_objects(scene.triangle_boxes(), scene.first_triangles());
  Contender contender{"binary", "adaptive"};
  contender.update = [=, &scene](const Moved& moved) -> Work {
    const dcem::TreeUpdateReport report = updater->update(*tree, moved.triangles, scene.triangle_boxes());
    const std::uint64_t nodes = report.nodes_refit + report.nodes_rebuilt, subtrees = report.subtrees_rebuilt;
    return {0, nodes, subtrees, 0, 0, subtrees, report.root_rebuilt ? "nodes" : ""};
  };
  set_queries(
      contender, threads,
      [tree, &scene](const Ray<double>& ray, TraversalCounters& sum) {
        const dcem::WatertightRay exact(ray);
        Answer closest_hit;
        const auto leaf = [&](std::uint32_t triangle, double& t_max) {
          const auto t = exact.intersect(scene.corners_m(triangle));
          if (t && *t >= ray.t_min && *t <= t_max && *t < closest_hit.t) closest_hit = {t_max = *t, triangle};
        };
        tree->closest(ray, leaf, &sum);
        return closest_hit;
      },
      [tree, &scene](const Ray<double>& ray, TraversalCounters& sum) {
        const dcem::WatertightRay exact(ray);
        const auto leaf = [&](std::uint32_t triangle) {
          const auto t = exact.intersect(scene.corners_m(triangle));
          return t && *t >= ray.t_min && *t <= ray.t_max;
        };
        return tree->any(ray, leaf, &sum);
      });
  contender.sah_cost = [tree] { return tree->sah_cost(); };
  return contender;
}

#if defined(DCEM_HAS_EMBREE)
Contender embree_contender(const dcem::Scene& scene, unsigned threads, const char* name,
                           dcem::bench::EmbreeUpkeep upkeep) {
  const auto moving = std::make_shared<dcem::bench::MovingEmbree>(scene, upkeep, threads);
  Contender contender{"embree", name};
  contender.prepare = [=](const Moved& moved) { moving->prepare(moved.bodies); };
  contender.update = [=](const Moved&) -> Work {
    moving->update();
    return {};
  };
  set_queries(
      contender, threads,
      [moving](const Ray<double>& ray, TraversalCounters&) {
        return Answer{static_cast<double>(moving->tree().closest_hit(ray))};
      },
      [moving](const Ray<double>& ray, TraversalCounters&) { return moving->tree().occluded(ray); });
  return contender;
}
#endif

struct Options {
  std::string file, series;
  std::vector<std::size_t> cars{100, 300, 1000};
  std::size_t frames = 100, rays = 4000;
  double limit = 1.1;
  bool sweep = false, two_threads = false;
  unsigned threads() const { return two_threads ? 2 : 1; }
};

/// The first is our own rebuild, whose hits the others must have.
std::vector<Contender> contenders(const dcem::Scene& scene, const Options& options) {
  const unsigned threads = options.threads();
  std::vector<Contender> all;
  all.push_back(wide_contender(scene, threads, WidePolicy::rebuild));
  all.push_back(wide_contender(scene, threads, WidePolicy::refit));
  const std::vector<double> one{options.limit}, many{1.0, 1.05, 1.1, 1.2, 1.5};
  for (const double limit : options.sweep ? many : one) {
    all.push_back(wide_contender(scene, threads, WidePolicy::reinsert, limit));
  }
  all.push_back(wide_contender(scene, threads, WidePolicy::grown_only, options.limit));
  add_kept_contenders(scene, threads, all);
  all.push_back(binary_contender(scene, threads));
#if defined(DCEM_HAS_EMBREE)
  using dcem::bench::EmbreeUpkeep;
  all.push_back(embree_contender(scene, threads, "rebuild", EmbreeUpkeep::rebuild));
  all.push_back(embree_contender(scene, threads, "refit", EmbreeUpkeep::refit));
  all.push_back(embree_contender(scene, threads, "two levels", EmbreeUpkeep::two_levels));
  all.push_back(embree_contender(scene, threads, "instances", EmbreeUpkeep::instances));
#endif
  return all;
}

/// Makes the rays of a frame: other ones in each frame, because surfaces move. All numbers are single-precision ones.
class RaySource {
 public:
  static constexpr double ground_layer_m = 10.0;  ///< bounces start no higher above the lowest point

  explicit RaySource(const dcem::Scene& scene) : scene_(scene) {
    for (const Vec3& vertex : scene.vertices_m()) bounds_.extend(vertex);
    for (std::uint32_t triangle = 0; triangle < scene.triangles().size(); ++triangle) {
      if (scene.triangle_boxes()[triangle].min.z < bounds_.min.z + 0.5 * ground_layer_m)
        near_ground_.push_back(triangle);
    }
  }

  void make(std::size_t frame, FrameRays& rays) const {
    dcem::RandomStream random(frame);
    for (Ray<double>& ray : rays.bounces) {
      const Vec3 direction = dcem::bench::direction_on_sphere(random);
      ray = {as_float(surface_point(random) + 0.01 * direction), as_float(direction)};
    }
    for (Ray<double>& ray : rays.segments) {
      const Vec3 from_m = dcem::bench::point_over(bounds_, 0.5, 3.0, random);
      const double azimuth_rad = dcem::bench::between(random, -dcem::pi, dcem::pi);
      const double length_m = dcem::bench::between(random, 1.0, dcem::bench::short_leg_m);
      const Vec3 to_m(from_m.x + length_m * std::cos(azimuth_rad), from_m.y + length_m * std::sin(azimuth_rad),
                      bounds_.min.z + dcem::bench::between(random, 0.5, 3.0));
      ray = dcem::segment_between(as_float(from_m), as_float(to_m));
    }
  }

 private:
  Vec3 surface_point(dcem::RandomStream& random) const {
    while (true) {
      const double share = random.uniform() * static_cast<double>(near_ground_.size());
      const auto [a, b, c] = scene_.corners_m(near_ground_[static_cast<std::size_t>(share)]);
      double u = random.uniform(), v = random.uniform();
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      const Vec3 point_m = a + u * (b - a) + v * (c - a);
      if (point_m.z <= bounds_.min.z + ground_layer_m) return point_m;
    }
  }

  const dcem::Scene& scene_;
  dcem::Aabb<double> bounds_;
  std::vector<std::uint32_t> near_ground_;
};

void follow(Contender& contender, const Moved& moved) {
  contender.prepare(moved);
  const Stopwatch watch;
  contender.last_work = contender.update(moved);
  contender.update_ms.push_back(watch.elapsed_ms());
  const Work& work = contender.last_work;
  contender.work.leaves += work.leaves;
  contender.work.nodes += work.nodes;
  contender.work.restructured += work.restructured;
}

/// Rays that are not timed; their answers are those of the frame before.
void warm_up(Contender& contender, const FrameRays& rays, Answers& unused) {
  TraversalCounters uncounted;
  contender.trace_closest_ms(rays.bounces, unused, uncounted);
  contender.trace_occluded_ms(rays.segments, unused, uncounted);
}

void trace(Contender& contender, const FrameRays& rays, Answers& hits, Answers& shadows) {
  TraversalCounters closest, occluded;
  const double count = static_cast<double>(rays.bounces.size());
  contender.closest_ms.push_back(contender.trace_closest_ms(rays.bounces, hits, closest));
  contender.occluded_ms.push_back(contender.trace_occluded_ms(rays.segments, shadows, occluded));
  TraversalCounters uncounted;
  contender.closest_again_ms.push_back(contender.trace_closest_ms(rays.bounces, hits, uncounted));
  contender.occluded_again_ms.push_back(contender.trace_occluded_ms(rays.segments, shadows, uncounted));
  contender.closest_steps.push_back(static_cast<double>(closest.nodes_visited) / count);
  contender.occluded_steps.push_back(static_cast<double>(occluded.nodes_visited) / count);
  contender.note_rays(closest, rays.bounces.size());
  contender.note_rays(occluded, rays.segments.size());
  for (const Answers* answers : {&hits, &shadows}) {
    for (const Answer& answer : *answers) {
      contender.hash = dcem::hash_values(contender.hash, std::bit_cast<std::uint64_t>(answer.t), answer.triangle);
    }
  }
}

/// Rays whose answers differ by more than 1e-5 of the distance and `floor`.
std::size_t count_differences(const Answers& answers, const Answers& expected, double floor) {
  std::size_t count = 0;
  for (std::size_t ray = 0; ray < answers.size(); ++ray) {
    const double t = answers[ray].t, right = expected[ray].t;
    if (!(t == right || std::abs(t - right) <= 1e-5 * std::abs(right) + floor)) ++count;
  }
  return count;
}

Moved moved_by(const dcem::Scene& scene, const dcem::ChangeSet& changes) {
  Moved moved{changes.moved, {}};
  for (const dcem::BodyId body : changes.moved) {
    const auto [first, last] = scene.triangle_range(body);
    for (std::uint32_t triangle = first; triangle < last; ++triangle) moved.triangles.push_back(triangle);
  }
  return moved;
}

struct FrameAnswers {
  Answers closest_hit, occluded;
};

/// False where a tree of ours hits what the first one does not.
bool check(std::size_t frame, std::vector<Contender>& all, const std::vector<FrameAnswers>& answers) {
  for (std::size_t index = 1; index < all.size(); ++index) {
    Contender& each = all[index];
    // Embree counts in single precision from the scene's origin: a tenth of a millimetre is what that tells at 1 km.
    const double floor = each.family == "embree" ? 1e-4 : 0.0;
    each.differences += count_differences(answers[index].closest_hit, answers[0].closest_hit, floor) +
                        count_differences(answers[index].occluded, answers[0].occluded, floor);
    if (each.family != "wide" || each.hash == all[0].hash) continue;
    std::fprintf(stderr, "frame %zu: wide %s %.2f does not hit what wide rebuild hits\n", frame, each.policy.c_str(),
                 each.limit);
    return false;
  }
  return true;
}

/// The file of `--series`: a row per frame and contender. It appears when it is complete.
class SeriesFile {
 public:
  /// Throws io::OutputError where it cannot be written.
  explicit SeriesFile(const std::string& path) : file_(path) {
    file_.write(
        "cars,frame,tree,policy,update_ms,closest_ns_per_ray,occluded_ns_per_ray,closest_steps,occluded_steps,"
        "sah_cost,leaves_written,nodes_visited,reinserted,rotated,rebuilt_in_place,rebuilt\n");
  }

  void add_frame(std::size_t cars, std::size_t frame, const Options& options, const std::vector<Contender>& all) {
    for (const Contender& each : all) {
      const std::string begin = std::to_string(cars) + "," + std::to_string(frame) + "," + each.family + "," +
                                each.policy + (options.sweep && each.limit != 0.0 ? number(" %.2f", each.limit) : "");
      file_.write(begin + times(each, static_cast<double>(options.rays)) + work(each) + "\n");
    }
  }

  void commit() { file_.commit(); }

 private:
  static std::string number(const char* format, double value) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, format, value);
    return buffer;
  }

  static std::string times(const Contender& each, double rays) {
    return number(",%.5f", each.update_ms.back()) + number(",%.2f", each.closest_ms.back() / rays * 1e6) +
           number(",%.2f", each.occluded_ms.back() / rays * 1e6);
  }

  /// Embree does not say.
  static std::string work(const Contender& each) {
    if (each.family == "embree") return ",,,,,,,,,";
    const Work& last = each.last_work;
    std::string cells = number(",%.3f", each.closest_steps.back()) + number(",%.3f", each.occluded_steps.back()) +
                        number(",%.4f", each.sah_cost());
    for (const std::uint64_t count : {last.leaves, last.nodes, last.reinserted, last.rotated, last.rebuilt_in_place}) {
      cells += "," + std::to_string(count);
    }
    return cells + "," + last.rebuilt;
  }

  dcem::io::AtomicFile file_;
};

bool drive(dcem::Scene& scene, std::size_t cars, const Options& options, std::vector<Contender>& all,
           std::optional<SeriesFile>& series) {
  const RaySource source(scene);
  FrameRays rays{Rays(options.rays), Rays(options.rays)};
  FrameRays others{Rays(4 * options.rays), Rays(4 * options.rays)};
  Answers unused(4 * options.rays);
  std::vector<FrameAnswers> answers(all.size(), {Answers(options.rays), Answers(options.rays)});
  for (std::size_t frame = 1; frame <= options.frames; ++frame) {
    const dcem::ChangeSet changes =
        scene.apply(scene.frame_at(dcem::bench::step_s * static_cast<double>(frame), frame));
    const Moved moved = moved_by(scene, changes);
    source.make(2 * frame, rays);
    source.make(2 * frame + 1, others);
    for (std::size_t turn = 0; turn < all.size(); ++turn) {
      const std::size_t index = (frame + turn) % all.size();
      warm_up(all[index], others, unused);
      follow(all[index], moved);
      trace(all[index], rays, answers[index].closest_hit, answers[index].occluded);
    }
    if (!check(frame, all, answers)) return false;
    if (series) series->add_frame(cars, frame, options, all);
  }
  for (const Contender& each : all) {
    const double asked = 2.0 * static_cast<double>(options.rays * options.frames);
    if (each.family != "binary" || static_cast<double>(each.differences) <= 1e-5 * asked) continue;
    std::fprintf(stderr, "binary %s: %llu hits differ\n", each.policy.c_str(),
                 static_cast<unsigned long long>(each.differences));
    return false;
  }
  return true;
}

/// A tenth of the frames, at the begin, in the middle or at the end.
enum class Window { first, middle, last };

double median_in(const std::vector<double>& series, Window window) {
  const std::size_t length = std::max<std::size_t>(1, series.size() / 10);
  const std::size_t rest = series.size() - length;
  const std::size_t begin = window == Window::first ? 0 : window == Window::middle ? rest / 2 : rest;
  const auto from = series.begin() + static_cast<std::ptrdiff_t>(begin);
  return dcem::median(std::vector<double>(from, from + static_cast<std::ptrdiff_t>(length)));
}

/// How many times as fast `one` is as `other` at the end, from the ratios of single frames.
double speed_up(const std::vector<double>& one_ms, const std::vector<double>& other_ms) {
  std::vector<double> ratio;
  for (std::size_t frame = 0; frame < one_ms.size(); ++frame) ratio.push_back(other_ms[frame] / one_ms[frame]);
  return median_in(ratio, Window::last);
}

/// Mean of both kinds of rays, milliseconds, at the end.
double ray_ms(const Contender& contender, double rays) {
  return 0.5 * (median_in(contender.closest_ms, Window::last) + median_in(contender.occluded_ms, Window::last)) / rays;
}

/// How many rays a frame make up for the dearer updates of `better`; absent where they never do.
std::optional<double> break_even_rays(const Contender& plain, const Contender& better, double rays) {
  const double price_ms = dcem::median(better.update_ms) - dcem::median(plain.update_ms);
  const double gain_ms = ray_ms(plain, rays) - ray_ms(better, rays);
  if (&plain == &better || !(gain_ms > 0.0)) return std::nullopt;
  return std::max(0.0, price_ms / gain_ms);
}

/// One drive, ready to be printed.
class Report {
 public:
  Report(std::string scene_name, std::size_t triangles, std::size_t cars, const Options& options,
         const std::vector<Contender>& all)
      : scene_name_(std::move(scene_name)), triangles_(triangles), cars_(cars), options_(options), all_(all) {}

  void print() const {
    std::fprintf(stderr,
                 "%s, %zu cars, %zu frames, %zu rays of each kind, %u thread(s); rates: Mrays/s in the last tenth\n"
                 "%-24s %9s %9s %9s | %9s %9s | %8s %8s %7s %7s | %7s %7s %7s %7s %7s | %7s\n",
                 scene_name_.c_str(), cars_, options_.frames, options_.rays, options_.threads(), "", "update ms", "p95",
                 "worst", "/embree2", "/rebuild", "closest", "occluded", "x embr2", "x embr2", "x fresh", "x fresh",
                 "again", "again", "SAH", "differ");
    for (const Contender& row : all_) print(row);
  }

 private:
  const Contender* find(const std::string& family, const char* policy) const {
    for (const Contender& each : all_) {
      if (each.family == family && each.policy == policy) return &each;
    }
    return nullptr;
  }
  double count() const { return static_cast<double>(options_.rays); }
  double rate(const std::vector<double>& ms, Window window) const { return count() / median_in(ms, window) / 1e3; }
  static std::string title(const Contender& row) {
    char limit[16] = "";
    if (row.limit != 0.0) std::snprintf(limit, sizeof limit, " %.2f", row.limit);
    return row.family + " " + row.policy + limit;
  }

  void print(const Contender& row) const {
    using dcem::median;
    const Contender* rival = find("embree", "two levels");
    const Contender* rebuilt = find(row.family, "rebuild");
    const Contender* refit = find(row.family, "refit");
    const double update_ms = median(row.update_ms);
    dcem::bench::CsvRow csv;
    csv.text(scene_name_).count(triangles_).count(cars_).count(options_.frames).count(options_.rays);
    csv.count(options_.threads()).text(row.family).text(row.policy);
    optional(csv, row.limit != 0.0 ? std::optional(row.limit) : std::nullopt, 2);
    const auto ratio = [&](const Contender* to, auto&& of, int decimals = 3) {
      optional(csv, to != nullptr ? std::optional(of(*to)) : std::nullopt, decimals);
    };
    const auto update_ratio = [&](const Contender& to) { return update_ms / median(to.update_ms); };
    const auto closest_ratio = [&](const Contender& to) { return speed_up(row.closest_ms, to.closest_ms); };
    const auto occluded_ratio = [&](const Contender& to) { return speed_up(row.occluded_ms, to.occluded_ms); };
    ratio(rival, update_ratio, 4);
    ratio(rebuilt, update_ratio, 4);
    ratio(
        rebuilt, [&](const Contender& to) { return dcem::quantile(row.update_ms, 1.0) / median(to.update_ms); }, 4);
    ratio(rival, closest_ratio);
    ratio(rival, occluded_ratio);
    ratio(rebuilt, closest_ratio);
    ratio(rebuilt, occluded_ratio);
    ratio(rebuilt, [&](const Contender& to) { return speed_up(row.closest_again_ms, to.closest_again_ms); });
    ratio(rebuilt, [&](const Contender& to) { return speed_up(row.occluded_again_ms, to.occluded_again_ms); });
    const bool has_sah = row.sah_cost() > 0.0;
    ratio(has_sah ? rebuilt : nullptr, [&](const Contender& to) { return row.sah_cost() / to.sah_cost(); });
    csv.number(update_ms + count() * ray_ms(row, count()), 3);
    optional(csv, rebuilt != nullptr ? break_even_rays(row, *rebuilt, count()) : std::nullopt, 0);
    optional(csv, refit != nullptr ? break_even_rays(*refit, row, count()) : std::nullopt, 0);
    csv.number(update_ms, 4).number(dcem::quantile(row.update_ms, 0.95), 4);
    csv.number(dcem::quantile(row.update_ms, 1.0), 4);
    for (const std::vector<double>* ms : {&row.closest_ms, &row.occluded_ms}) {
      for (const Window window : {Window::first, Window::middle, Window::last}) csv.number(rate(*ms, window), 3);
    }
    for (const std::vector<double>* steps : {&row.closest_steps, &row.occluded_steps}) {
      for (const Window window : {Window::first, Window::middle, Window::last}) {
        optional(csv, row.family != "embree" ? std::optional(median_in(*steps, window)) : std::nullopt, 2);
      }
    }
    optional(csv, has_sah ? std::optional(row.sah_cost()) : std::nullopt, 3);
    csv.count(row.work.leaves).count(row.work.nodes).count(row.work.restructured).count(row.differences);
    csv.hash(row.hash).print();
    print_line(row, rival, rebuilt);
  }

  void print_line(const Contender& row, const Contender* rival, const Contender* rebuilt) const {
    using dcem::median;
    const double update_ms = median(row.update_ms);
    const auto over = [&](const Contender* to) { return to != nullptr ? update_ms / median(to->update_ms) : 0.0; };
    const auto faster = [&](const Contender* to, std::vector<double> Contender::*ms) {
      return to != nullptr ? speed_up(row.*ms, to->*ms) : 0.0;
    };
    std::fprintf(stderr,
                 "%-24s %9.4f %9.4f %9.4f | %9.4f %9.4f | %8.2f %8.2f %7.3f %7.3f | %7.3f %7.3f %7.3f %7.3f %7.2f | "
                 "%7llu\n",
                 title(row).c_str(), update_ms, dcem::quantile(row.update_ms, 0.95), dcem::quantile(row.update_ms, 1.0),
                 over(rival), over(rebuilt), rate(row.closest_ms, Window::last), rate(row.occluded_ms, Window::last),
                 faster(rival, &Contender::closest_ms), faster(rival, &Contender::occluded_ms),
                 faster(rebuilt, &Contender::closest_ms), faster(rebuilt, &Contender::occluded_ms),
                 faster(rebuilt, &Contender::closest_again_ms), faster(rebuilt, &Contender::occluded_again_ms),
                 row.sah_cost(), static_cast<unsigned long long>(row.differences));
  }

  static void optional(dcem::bench::CsvRow& csv, std::optional<double> value, int decimals) {
    if (value) {
      csv.number(*value, decimals);
    } else {
      csv.empty();
    }
  }

  std::string scene_name_;
  std::size_t triangles_, cars_;
  const Options& options_;
  const std::vector<Contender>& all_;
};

bool bench(const Options& options, std::optional<SeriesFile>& series) {
  const dcem::TriangleMesh scenery = dcem::io::read_obj(options.file).mesh;
  const std::string name = std::filesystem::path(options.file).stem().string();
  for (const std::size_t cars : options.cars) {
    const double duration_s = dcem::bench::step_s * static_cast<double>(options.frames);
    dcem::Scene scene = dcem::bench::scene_with_cars(scenery, cars, duration_s, 1);
    std::vector<Contender> all = contenders(scene, options);
    if (!drive(scene, cars, options, all, series)) return false;
    Report(name, scene.triangles().size(), cars, options, all).print();
  }
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  CLI::App app("Times a tree that follows driving cars, and rays through it");
  app.add_option("FILE", options.file, "OBJ file")->required();
  app.add_option("--cars", options.cars, "numbers of cars")->check(CLI::Range(1, 100'000));
  app.add_option("--frames", options.frames, "frames of each drive")->check(CLI::Range(1, 1'000'000));
  app.add_option("--rays", options.rays, "rays of each kind in a frame")->check(CLI::Range(4, 100'000'000));
  auto* limit = app.add_option("--limit", options.limit, "growth from which on a car is reinserted; default 1.1");
  app.add_flag("--sweep", options.sweep, "the limits 1.0, 1.05, 1.1, 1.2 and 1.5")->excludes(limit);
  app.add_flag("--two-threads", options.two_threads, "rays on two threads, and what Embree builds");
  app.add_option("--series", options.series, "CSV file for a row per frame and tree");
  return dcem::bench::run_program(app, count, arguments, [&] {
    std::optional<SeriesFile> series;  // before anything is read: who cannot write shall not drive for an hour
    if (!options.series.empty()) series.emplace(options.series);
    std::puts(
        "scene,triangles,cars,frames,rays,threads,tree,policy,growth_limit,update_to_embree_two_levels,"
        "update_to_rebuild,worst_update_to_rebuild,closest_rate_to_embree_two_levels,"
        "occluded_rate_to_embree_two_levels,closest_rate_to_rebuild,occluded_rate_to_rebuild,closest_again_to_rebuild,"
        "occluded_again_to_rebuild,sah_to_rebuild,frame_ms,"
        "break_even_rays_of_rebuild,break_even_rays_over_refit,update_median_ms,update_p95_ms,update_maximum_ms,"
        "closest_mrays_first,closest_mrays_middle,closest_mrays_last,occluded_mrays_first,occluded_mrays_middle,"
        "occluded_mrays_last,closest_steps_first,closest_steps_middle,closest_steps_last,occluded_steps_first,"
        "occluded_steps_middle,occluded_steps_last,sah_cost,leaves_written,nodes_visited,restructured,differences,"
        "hash");
    const bool done = bench(options, series);
    if (done && series) series->commit();
    return done;
  });
}
