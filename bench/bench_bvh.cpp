/// Times how a tree is kept while cars drive: rebuild, refit, or decide for each subtree.
///
///   bench_bvh [TOWN.obj] [--cars V...] [--frames N] [--rays R] [--sweep]
///
/// All policies follow the same drive, one after the other within each frame, and the same rays go through each of
/// their trees. One CSV row per number of cars and policy. Hits that differ between policies are an error: exit 1.
#include <algorithm>
#include <bit>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_program.hpp"
#include "bench/moving_boxes.hpp"
#include "dcem/accel/binary/updater.hpp"
#include "dcem/core/statistics.hpp"
#include "dcem/geometry/triangle.hpp"

namespace {

using dcem::Ray;
using dcem::TreePolicy;
using dcem::bench::RaySet;
using dcem::bench::Stopwatch;

/// One policy with its tree, and what it took, frame by frame.
struct Contender {
  std::string policy;
  dcem::TreeUpdateSettings settings;
  dcem::BvhUpdater<double> updater{settings};
  dcem::Bvh<double> tree{};
  std::vector<double> update_ms{}, closest_ms{}, any_ms{};  ///< of a frame
  std::vector<double> closest_steps{}, any_steps{};         ///< nodes visited, per ray
  std::vector<double> sah_cost{};
  std::uint64_t nodes_refit = 0, nodes_rebuilt = 0, subtrees_rebuilt = 0, hash = 0;
};

Contender contender(const char* name, TreePolicy policy, std::optional<double> growth_limit = {}) {
  dcem::TreeUpdateSettings settings;
  settings.policy = policy;
  settings.sah_growth_limit = growth_limit.value_or(settings.sah_growth_limit);
  return {name, settings};
}

/// The first builds a new tree in every frame: it is what the others are compared with.
std::vector<Contender> contenders(bool sweep) {
  std::vector<Contender> all;
  all.push_back(contender("rebuild_always", TreePolicy::rebuild_always));
  all.push_back(contender("refit_only", TreePolicy::refit_only));
  if (!sweep) all.push_back(contender("adaptive", TreePolicy::adaptive));
  for (const double limit : {1.1, 1.2, 1.5, 2.0}) {
    if (sweep) all.push_back(contender("adaptive", TreePolicy::adaptive, limit));
  }
  return all;
}

void follow(Contender& contender, const dcem::Scene& scene, const std::vector<std::uint32_t>& moved) {
  const Stopwatch watch;
  const dcem::TreeUpdateReport report = contender.updater.update(contender.tree, moved, scene.triangle_boxes());
  contender.update_ms.push_back(watch.elapsed_ms());
  contender.nodes_refit += report.nodes_refit;
  contender.nodes_rebuilt += report.nodes_rebuilt;
  contender.subtrees_rebuilt += report.subtrees_rebuilt;
  contender.sah_cost.push_back(report.sah_cost);
}

/// Parameter of the closest hit, infinity where there is none.
double nearest_hit(const Contender& contender, const dcem::Scene& scene, const Ray<double>& ray,
                   dcem::TraversalCounters& counters) {
  const dcem::WatertightRay exact(ray);
  double closest_hit = ray.t_max;
  const auto leaf = [&](std::uint32_t triangle, double& t_max) {
    const auto t = exact.intersect(scene.corners_m(triangle));
    if (t && *t >= ray.t_min && *t < closest_hit) closest_hit = t_max = *t;
  };
  contender.tree.closest(ray, leaf, &counters);
  return closest_hit;
}

bool any_hit(const Contender& contender, const dcem::Scene& scene, const Ray<double>& ray,
             dcem::TraversalCounters& counters) {
  const dcem::WatertightRay exact(ray);
  const auto leaf = [&](std::uint32_t triangle) {
    const auto t = exact.intersect(scene.corners_m(triangle));
    return t && *t >= ray.t_min && *t <= ray.t_max;
  };
  return contender.tree.any(ray, leaf, &counters);
}

/// Times both kinds of rays and chains what they hit to the contender's hash.
void trace(Contender& contender, const dcem::Scene& scene, const RaySet& rays) {
  dcem::TraversalCounters closest, any;
  const double count = static_cast<double>(rays.bounces.size());
  const Stopwatch closest_watch;
  for (const Ray<double>& ray : rays.bounces) {
    const double t = nearest_hit(contender, scene, ray, closest);
    contender.hash = dcem::hash_values(contender.hash, std::bit_cast<std::uint64_t>(t));
  }
  contender.closest_ms.push_back(closest_watch.elapsed_ms());
  const Stopwatch any_tracked;
  for (const Ray<double>& ray : rays.short_legs) {
    contender.hash = dcem::hash_values(contender.hash, any_hit(contender, scene, ray, any) ? 1 : 0);
  }
  contender.any_ms.push_back(any_tracked.elapsed_ms());
  contender.closest_steps.push_back(static_cast<double>(closest.nodes_visited) / count);
  contender.any_steps.push_back(static_cast<double>(any.nodes_visited) / count);
}

std::vector<std::uint32_t> moved_triangles(const dcem::Scene& scene, const dcem::ChangeSet& changes) {
  std::vector<std::uint32_t> moved;
  for (const dcem::BodyId body : changes.moved) {
    const auto [first, last] = scene.triangle_range(body);
    for (std::uint32_t triangle = first; triangle < last; ++triangle) moved.push_back(triangle);
  }
  return moved;
}

/// False in a frame in which policies hit different things.
bool drive(dcem::Scene& scene, std::size_t frames, std::size_t ray_count, std::vector<Contender>& all) {
  for (Contender& each : all) each.tree.build_objects(scene.triangle_boxes(), scene.first_triangles());
  const RaySet rays = dcem::bench::random_rays(all.front().tree.bounds(), ray_count, 7);
  for (std::size_t frame = 1; frame <= frames; ++frame) {
    const dcem::ChangeSet changes =
        scene.apply(scene.frame_at(dcem::bench::step_s * static_cast<double>(frame), frame));
    const std::vector<std::uint32_t> moved = moved_triangles(scene, changes);
    for (std::size_t turn = 0; turn < all.size(); ++turn) {
      Contender& each = all[(frame + turn) % all.size()];  // nobody always comes first
      follow(each, scene, moved);
      trace(each, scene, rays);
    }
    for (const Contender& each : all) {
      if (each.hash == all.front().hash) continue;
      std::fprintf(stderr, "frame %zu: %s does not hit what %s hits\n", frame, each.policy.c_str(),
                   all.front().policy.c_str());
      return false;
    }
  }
  return true;
}

double sum_of_medians(const Contender& contender) {
  return dcem::median(contender.update_ms) + dcem::median(contender.closest_ms) + dcem::median(contender.any_ms);
}

void print(const std::string& name, const dcem::Scene& scene, std::size_t cars, const Contender& row,
           const Contender& rebuilt) {
  using dcem::median;
  const std::size_t frames = row.update_ms.size();
  dcem::bench::CsvRow csv;
  csv.text(name).count(scene.triangles().size()).count(cars).count(frames).text(row.policy);
  if (row.settings.policy == TreePolicy::adaptive) {
    csv.number(row.settings.sah_growth_limit, 2);
  } else {
    csv.empty();
  }
  csv.number(sum_of_medians(row) / sum_of_medians(rebuilt), 3);
  csv.number(median(row.update_ms) / median(rebuilt.update_ms), 4);
  csv.number(median(row.closest_ms) / median(rebuilt.closest_ms), 3);
  csv.number(row.sah_cost.back() / rebuilt.sah_cost.back(), 3);
  csv.number(median(row.update_ms), 3).number(dcem::quantile(row.update_ms, 0.95), 3);
  csv.number(dcem::quantile(row.update_ms, 1.0), 3);
  csv.number(median(row.closest_ms), 3).number(median(row.any_ms), 3);
  for (const std::vector<double>& steps : {row.closest_steps, row.any_steps}) {
    csv.number(steps.front(), 2).number(steps[(frames - 1) / 2], 2).number(steps.back(), 2);
  }
  csv.number(row.sah_cost.back(), 3).number(row.tree.quality().sah_at_build, 3);
  csv.count(row.nodes_refit).count(row.nodes_rebuilt).count(row.subtrees_rebuilt).hash(row.hash).print();
}

struct Options {
  std::string file;
  std::vector<std::size_t> cars{100, 300, 1000};
  std::size_t frames = 100, rays = 2000;
  bool sweep = false;
};

bool bench(const Options& options) {
  const dcem::TriangleMesh scenery =
      options.file.empty() ? dcem::bench::generated_town(1) : dcem::io::read_obj(options.file).mesh;
  const std::string name = options.file.empty() ? "generated" : std::filesystem::path(options.file).stem().string();
  for (const std::size_t cars : options.cars) {
    const double duration_s = dcem::bench::step_s * static_cast<double>(options.frames);
    dcem::Scene scene = dcem::bench::scene_with_cars(scenery, cars, duration_s, 1);
    std::vector<Contender> all = contenders(options.sweep);
    if (!drive(scene, options.frames, options.rays, all)) return false;
    for (const Contender& row : all) print(name, scene, cars, row, all.front());
  }
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  CLI::App app("Times how a tree is kept while cars drive");
  app.add_option("TOWN", options.file, "OBJ file; default: a generated town");
  app.add_option("--cars", options.cars, "numbers of cars")->check(CLI::Range(1, 100'000));
  app.add_option("--frames", options.frames, "frames of each drive")->check(CLI::Range(1, 1'000'000));
  app.add_option("--rays", options.rays, "rays of each kind in a frame")->check(CLI::Range(1, 100'000'000));
  app.add_flag("--sweep", options.sweep, "adaptive with the growth limits 1.1, 1.2, 1.5 and 2");
  return dcem::bench::run_program(app, count, arguments, [&] {
    std::puts(
        "scene,triangles,cars,frames,policy,sah_growth_limit,total_to_rebuild,update_to_rebuild,closest_to_rebuild,"
        "sah_to_fresh,update_median_ms,update_p95_ms,update_maximum_ms,closest_median_ms,any_median_ms,"
        "closest_steps_first,closest_steps_middle,closest_steps_last,any_steps_first,any_steps_middle,any_steps_last,"
        "sah_cost,sah_cost_at_build,nodes_refit,nodes_rebuilt,subtrees_rebuilt,hash");
    return bench(options);
  });
}
