/// Times rays through a scene that stands still: the wide tree, the binary tree, and Embree where it was found.
///
///   bench_trace ROUNDS FILE.obj... [--copies N] [--rays R] [--two-threads]
///
/// All trees get the same rays, in turns. One CSV row per scene, kind of ray and tree; a table that a person reads goes
/// to standard error. Hits that differ by more than 1e-5 of their distance from those of the binary tree, which is all
/// double, or are there for one tree only, are counted; for our own trees more than one in 100,000 is an error: exit 1.
/// (Embree counts in single precision from the scene's origin.)
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_program.hpp"
#include "bench/moving_boxes.hpp"
#include "bench/timed_rays.hpp"
#include "dcem/accel/bvh.hpp"
#include "dcem/accel/wide/trace/batch.hpp"
#include "dcem/accel/wide/trace/ray_order.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/statistics.hpp"
#if defined(DCEM_HAS_EMBREE)
#include "bench/embree_scene.hpp"
#endif

namespace {

using dcem::Ray;
using dcem::TraversalCounters;
using dcem::Vec3;
using dcem::bench::as_float;
using dcem::bench::Stopwatch;
using dcem::bench::timed;

/// One tree: how it is built, and what it says of a ray.
struct Contender {
  std::string name;
  std::function<void()> build;
  std::function<double(const std::vector<Ray<double>>&, std::vector<double>&, TraversalCounters&)> closest_ms;
  std::function<double(const std::vector<Ray<double>>&, std::vector<double>&, TraversalCounters&)> occluded_ms;
  std::vector<double> build_ms{};
};

/// Gives a contender the two loops over its tree.
template <typename ClosestHit, typename Occluded>
void set_queries(Contender& contender, unsigned threads, ClosestHit closest_hit, Occluded occluded) {
  contender.closest_ms = [=](const auto& rays, auto& answers, auto& counters) {
    return timed(rays, answers, counters, threads, closest_hit);
  };
  contender.occluded_ms = [=](const auto& rays, auto& answers, auto& counters) {
    return timed(rays, answers, counters, threads,
                 [&](const Ray<double>& ray, TraversalCounters& sum) { return occluded(ray, sum) ? 1.0 : 0.0; });
  };
}

constexpr double none = std::numeric_limits<double>::infinity();
constexpr const char* rival_name = "embree robust";

Contender wide_contender(const std::string& name, const dcem::Scene& scene, const dcem::TriangleView& mesh,
                         const dcem::WideSettings& settings) {
  const auto tree = std::make_shared<dcem::WideBvh>();
  Contender contender{name, {}, {}, {}};
  contender.build = [=, &scene] { tree->build(mesh, scene.triangle_boxes(), settings); };
  set_queries(
      contender, settings.threads,
      [tree](const Ray<double>& ray, TraversalCounters& sum) {
        const auto hit = tree->closest_hit(ray, &sum);
        return hit ? hit->t : none;
      },
      [tree](const Ray<double>& ray, TraversalCounters& sum) { return tree->occluded(ray, &sum); });
  return contender;
}

/// All rays of a kind at once; the time holds their sorting.
Contender batch_contender(const dcem::Scene& scene, const dcem::TriangleView& mesh, unsigned threads) {
  struct Tree {
    explicit Tree(unsigned threads) : batch(threads) {}

    dcem::WideBvh tree;
    dcem::WideBatch batch;
    std::vector<std::optional<dcem::TriangleHit>> hits;
    std::vector<std::uint8_t> occluded;
  };
  const auto own = std::make_shared<Tree>(threads);
  Contender contender{"wide, batch", {}, {}, {}};
  contender.build = [=, &scene] { own->tree.build(mesh, scene.triangle_boxes()); };
  contender.closest_ms = [=](const auto& rays, auto& answers, auto& counters) {
    own->hits.resize(rays.size());
    const Stopwatch watch;
    own->batch.closest_hit(own->tree, rays, own->hits, {}, &counters);
    const double elapsed_ms = watch.elapsed_ms();
    std::transform(own->hits.begin(), own->hits.end(), answers.begin(),
                   [](const auto& hit) { return hit ? hit->t : none; });
    return elapsed_ms;
  };
  contender.occluded_ms = [=](const auto& rays, auto& answers, auto& counters) {
    own->occluded.resize(rays.size());
    const Stopwatch watch;
    own->batch.occluded(own->tree, rays, own->occluded, {}, &counters);
    const double elapsed_ms = watch.elapsed_ms();
    std::copy(own->occluded.begin(), own->occluded.end(), answers.begin());
    return elapsed_ms;
  };
  return contender;
}

Contender binary_contender(const dcem::Scene& scene, unsigned threads) {
  const auto tree = std::make_shared<dcem::Bvh<double>>();
  Contender contender{"binary, double", {}, {}, {}};
  contender.build = [=, &scene] { tree->build(scene.triangle_boxes()); };
  set_queries(
      contender, threads,
      [tree, &scene](const Ray<double>& ray, TraversalCounters& sum) {
        const dcem::WatertightRay exact(ray);
        double closest_hit = none;
        const auto leaf = [&](std::uint32_t triangle, double& t_max) {
          const auto t = exact.intersect(scene.corners_m(triangle));
          if (t && *t >= ray.t_min && *t <= t_max && *t < closest_hit) closest_hit = t_max = *t;
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
  return contender;
}

#if defined(DCEM_HAS_EMBREE)
Contender embree_contender(const std::string& name, const dcem::TriangleView& mesh,
                           const dcem::bench::EmbreeSettings& settings) {
  const auto tree = std::make_shared<std::unique_ptr<dcem::bench::EmbreeScene>>();
  const auto quads = std::make_shared<std::vector<dcem::Quad>>();
  if (settings.quads) {
    dcem::detail::QuadBuilder(mesh, dcem::WideSettings{}.pair_flatness)
        .append(0, static_cast<std::uint32_t>(mesh.size()), *quads);
  }
  Contender contender{name, {}, {}, {}};
  contender.build = [=] {
    *tree = std::make_unique<dcem::bench::EmbreeScene>(settings);
    (*tree)->attach((*tree)->add(mesh, *quads));
    (*tree)->commit();
  };
  set_queries(
      contender, settings.threads,
      [tree](const Ray<double>& ray, TraversalCounters&) { return static_cast<double>((*tree)->closest_hit(ray)); },
      [tree](const Ray<double>& ray, TraversalCounters&) { return (*tree)->occluded(ray); });
  return contender;
}

/// As the robust tree, its rays in the order of our batches; sorting and copying them is not timed.
Contender sorted_embree_contender(const dcem::TriangleView& mesh, unsigned threads) {
  const Contender plain = embree_contender("embree robust, sorted", mesh, {.threads = threads});
  const auto sorted = [](const auto& trace) {
    return [trace](const std::vector<Ray<double>>& rays, std::vector<double>& answers, TraversalCounters& counters) {
      dcem::RayOrder order;
      const auto positions = order.sort(rays);
      std::vector<Ray<double>> in_order;
      for (const std::uint32_t position : positions) in_order.push_back(rays[position]);
      std::vector<double> own(rays.size());
      const double elapsed_ms = trace(in_order, own, counters);
      for (std::size_t at = 0; at < own.size(); ++at) answers[positions[at]] = own[at];
      return elapsed_ms;
    };
  };
  Contender contender{plain.name, plain.build, sorted(plain.closest_ms), sorted(plain.occluded_ms)};
  return contender;
}
#endif

std::vector<Contender> contenders(const dcem::Scene& scene, const dcem::TriangleView& mesh, unsigned threads) {
  using dcem::WideQuality;
  std::vector<Contender> all;
  all.push_back(wide_contender("wide, pairs", scene, mesh, {.threads = threads}));
  all.push_back(wide_contender("wide, fast build", scene, mesh, {.threads = threads, .quality = WideQuality::fast}));
  all.push_back(wide_contender("wide, high quality", scene, mesh, {.threads = threads, .quality = WideQuality::high}));
  all.push_back(batch_contender(scene, mesh, threads));
#if defined(DCEM_HAS_EMBREE)
  all.push_back(embree_contender(rival_name, mesh, {.threads = threads}));
  all.push_back(sorted_embree_contender(mesh, threads));
  all.push_back(embree_contender("embree robust quads", mesh, {.quads = true, .threads = threads}));
  all.push_back(embree_contender("embree medium", mesh, {.robust = false, .threads = threads}));
  all.push_back(embree_contender("embree medium quads", mesh, {.robust = false, .quads = true, .threads = threads}));
#endif
  all.push_back(wide_contender("wide, triangles", scene, mesh, {.pair_flatness = -1.0, .threads = threads}));
  all.push_back(binary_contender(scene, threads));
  return all;
}

struct RayKind {
  std::string name;
  std::vector<Ray<double>> rays;
};

/// The rays of a picture from above, rays that leave surfaces in all directions, and segments between points near the
/// ground. All numbers are single-precision ones, so that everybody gets the same.
std::vector<RayKind> ray_kinds(const dcem::TriangleView& mesh, const dcem::Aabb<double>& bounds, std::size_t count) {
  dcem::RandomStream random(3);
  std::vector<RayKind> kinds{{"primary", {}}, {"bounce", {}}, {"segment", {}}};
  const Vec3 eye_m = as_float({bounds.center().x, bounds.center().y, bounds.max.z * 1.2});
  const auto side = static_cast<std::size_t>(std::sqrt(static_cast<double>(count)));
  for (std::size_t ray = 0; ray < count; ++ray) {
    const double x = static_cast<double>(ray % side) / static_cast<double>(side) - 0.5;
    const double y = static_cast<double>(ray / side) / static_cast<double>(side) - 0.5;
    kinds[0].rays.push_back({eye_m, as_float(glm::normalize(Vec3(2 * x, 2 * y, -0.7)))});
    const auto triangle = static_cast<std::uint32_t>(random.uniform() * static_cast<double>(mesh.size()));
    const auto [a, b, c] = mesh.corners_m(triangle);
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
    const Vec3 direction = dcem::bench::direction_on_sphere(random);
    kinds[1].rays.push_back({as_float(a + u * (b - a) + v * (c - a) + 0.01 * direction), as_float(direction)});
    Vec3 way = dcem::bench::direction_on_sphere(random);
    way.z *= 0.2;
    const Vec3 from_m = as_float(dcem::bench::point_over(bounds, 0.5, 20.0, random));
    const Vec3 to_m = as_float(from_m + way * dcem::bench::between(random, 5.0, 150.0));
    kinds[2].rays.push_back(dcem::segment_between(from_m, to_m));
  }
  return kinds;
}

/// N × N copies side by side.
dcem::TriangleMesh tiled(const dcem::TriangleMesh& mesh, int copies) {
  dcem::Aabb<double> bounds;
  for (const Vec3& vertex : mesh.vertices_m) bounds.extend(vertex);
  dcem::TriangleMesh result = mesh;
  result.vertices_m.clear();
  result.triangles.clear();
  for (int copy = 0; copy < copies * copies; ++copy) {
    const Vec3 shift_m(bounds.extent().x * (copy % copies), bounds.extent().y * (copy / copies), 0.0);
    const auto first = static_cast<std::uint32_t>(result.vertices_m.size());
    for (const Vec3& vertex : mesh.vertices_m) result.vertices_m.push_back(vertex + shift_m);
    for (auto triangle : mesh.triangles) {
      for (std::uint32_t& vertex : triangle.vertices) vertex += first;
      result.triangles.push_back(triangle);
    }
  }
  return result;
}

/// Rays whose answers differ by more than the distance allows.
std::size_t count_differences(const std::vector<double>& answers, const std::vector<double>& expected) {
  std::size_t count = 0;
  for (std::size_t ray = 0; ray < answers.size(); ++ray) {
    const bool same =
        answers[ray] == expected[ray] || std::abs(answers[ray] - expected[ray]) <= 1e-5 * std::abs(expected[ray]);
    if (!same) ++count;
  }
  return count;
}

struct Row {
  std::vector<double> ms;
  std::vector<double> answers;
  TraversalCounters counters;
};

bool compare(const std::string& scene_name, std::size_t triangles, std::vector<Contender>& all, const RayKind& kind,
             bool closest_hit, std::size_t rounds, unsigned threads) {
  std::vector<Row> rows(all.size());
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t turn = 0; turn < all.size(); ++turn) {
      const std::size_t index = (round + turn) % all.size();
      Row& row = rows[index];
      row.answers.resize(kind.rays.size());
      row.counters = {};
      row.ms.push_back(
          (closest_hit ? all[index].closest_ms : all[index].occluded_ms)(kind.rays, row.answers, row.counters));
    }
  }
  const double count = static_cast<double>(kind.rays.size());
  // Without Embree there is nothing to compare with but ourselves, and the cell stays empty.
  const auto rival = std::find_if(all.begin(), all.end(), [](const Contender& one) { return one.name == rival_name; });
  const double rival_ms =
      rival != all.end() ? dcem::median(rows[static_cast<std::size_t>(rival - all.begin())].ms) : 0.0;
  bool same = true;
  for (std::size_t index = 0; index < all.size(); ++index) {
    const double ms = dcem::median(rows[index].ms);
    const std::size_t differences = count_differences(rows[index].answers, rows.back().answers);
    const bool is_ours = all[index].name.starts_with("wide");
    same = same && (!is_ours || static_cast<double>(differences) <= 1e-5 * count);
    std::uint64_t hash = 0;
    for (const double answer : rows[index].answers) {
      hash = dcem::hash_values(hash, std::bit_cast<std::uint64_t>(answer));
    }
    dcem::bench::CsvRow csv;
    csv.text(scene_name).count(triangles).count(threads).text(kind.name).text(closest_hit ? "closest" : "occluded");
    csv.text("\"" + all[index].name + "\"");
    rival_ms > 0.0 ? csv.number(rival_ms / ms, 3) : csv.empty();
    csv.number(count / ms / 1e3, 3);
    csv.number(dcem::median(all[index].build_ms), 2);
    csv.number(static_cast<double>(rows[index].counters.nodes_visited) / count, 2);
    csv.number(static_cast<double>(rows[index].counters.primitives_tested) / count, 2);
    csv.count(differences).hash(hash).print();
    std::fprintf(stderr, "%-14s %-8s %-8s %-22s %6.2f x  %7.2f Mrays/s  %zu differ\n", scene_name.c_str(),
                 kind.name.c_str(), closest_hit ? "closest" : "occluded", all[index].name.c_str(), rival_ms / ms,
                 count / ms / 1e3, differences);
  }
  return same;
}

struct Options {
  std::size_t rounds = 5;
  std::vector<std::string> files;
  int copies = 1;
  std::size_t rays = 131'072;
  bool two_threads = false;
  unsigned threads() const { return two_threads ? 2 : 1; }
};

bool bench(const Options& options, const std::string& file) {
  const dcem::TriangleMesh scenery = tiled(dcem::io::read_obj(file).mesh, options.copies);
  dcem::Scene scene;
  for (const std::string& name : scenery.material_names) scene.add_material({name, dcem::PerfectConductor{}});
  scene.set_scenery(scenery);
  const dcem::TriangleView mesh{scene.vertices_m(), scene.triangles()};
  std::vector<Contender> all = contenders(scene, mesh, options.threads());
  for (std::size_t round = 0; round < options.rounds; ++round) {
    for (Contender& each : all) {
      const Stopwatch watch;
      each.build();
      each.build_ms.push_back(watch.elapsed_ms());
    }
  }
  for (const Contender& each : all) {
    std::fprintf(stderr, "%-22s built in %.1f ms\n", each.name.c_str(), dcem::median(each.build_ms));
  }
  dcem::Aabb<double> bounds;
  for (const Vec3& vertex : mesh.vertices_m) bounds.extend(vertex);
  const std::string name = std::filesystem::path(file).stem().string() +
                           (options.copies > 1 ? " x " + std::to_string(options.copies * options.copies) : "");
  bool same = true;
  for (const RayKind& kind : ray_kinds(mesh, bounds, options.rays)) {
    for (const bool closest_hit : {true, false}) {
      same = compare(name, mesh.size(), all, kind, closest_hit, options.rounds, options.threads()) && same;
    }
  }
  if (!same) std::fputs("hits differ\n", stderr);
  return same;
}

}  // namespace

int main(int count, char** arguments) {
  Options options;
  CLI::App app("Times rays through a scene that stands still");
  app.add_option("ROUNDS", options.rounds, "rounds, in turns")->required()->check(CLI::Range(1, 1000));
  app.add_option("FILES", options.files, "OBJ files")->required();
  app.add_option("--copies", options.copies, "N x N copies of the scene")->check(CLI::Range(1, 16));
  app.add_option("--rays", options.rays, "rays of each kind")->check(CLI::Range(1, 100'000'000));
  app.add_flag("--two-threads", options.two_threads, "builds and rays on two threads");
  return dcem::bench::run_program(app, count, arguments, [&] {
    std::puts(
        "scene,triangles,threads,rays,query,tree,ratio_to_embree_robust,mrays_per_s,build_ms,nodes_per_ray,patches_per_"
        "ray,"
        "differences,hash");
    bool same = true;
    for (const std::string& file : options.files) same = bench(options, file) && same;
    return same;
  });
}
