/// Times rays through a scene that stands still: the wide tree, the binary tree, and Embree where it was found.
///
///   bench_trace ROUNDS FILE.obj... [--copies N] [--rays R] [--two-threads]
///
/// All trees get the same rays, in turns. One CSV row per scene, kind of ray and tree; a table that a person reads goes
/// to standard error. Hits that differ by more than 1e-5 of their distance from those of the binary tree, which is all
/// double, or are there for one tree only, are counted; for our own trees more than one in 100,000 is an error: exit 1.
/// (`wide, simulator` is held against the binary tree with the same filters. Embree counts in single precision from the
/// scene's origin.)
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_program.hpp"
#include "bench/moving_boxes.hpp"
#include "bench/tiled_mesh.hpp"
#include "bench/timed_rays.hpp"
#include "dcem/accel/binary_index.hpp"
#include "dcem/accel/ray_order.hpp"
#include "dcem/accel/wide_bvh.hpp"
#include "dcem/core/statistics.hpp"
#include "dcem/paths/discover/launch_sphere.hpp"
#include "dcem/paths/query/leg_filter.hpp"
#if defined(DCEM_HAS_EMBREE)
#include "bench/embree_scene.hpp"
#endif

namespace {

using dcem::Ray;
using dcem::TraversalCounters;
using dcem::Vec3;
using dcem::bench::as_float;
using dcem::bench::Stopwatch;
using dcem::bench::timed_pieces;

/// Rays of one kind, and the facets that they leave, where they leave one.
struct RayKind {
  std::string name;
  std::vector<Ray<double>> rays;
  std::vector<dcem::FacetId> from{};  ///< one per ray, or none at all
  std::size_t rays_a_sphere = 0;      ///< 0: no spheres
};

/// Traces all rays of a kind once; the time, milliseconds, is that of the queries alone.
using Trace = std::function<double(std::vector<double>&, TraversalCounters&)>;

/// One tree: how it is built, and how it is asked about rays. What a tree needs its rays to look like is prepared
/// before the clock starts, for every tree.
struct Contender {
  std::string name;
  std::function<void()> build;
  std::function<Trace(const RayKind&)> closest, occluded;
  /// What its answers must be, where they are not those of the binary tree: (kind, closest hits or not).
  std::function<std::vector<double>(const RayKind&, bool)> expected{};
  std::vector<double> build_ms{};
};

constexpr double none = std::numeric_limits<double>::infinity();
constexpr const char* rival_name = "embree robust";
constexpr const char* packet_name = "embree robust packet";

/// Calls `ask(ray index, counters)` for all rays; its answers are kept.
template <typename Ask>
Trace one_by_one(const RayKind& kind, unsigned threads, Ask ask) {
  return [&kind, threads, ask](std::vector<double>& answers, TraversalCounters& counters) {
    return timed_pieces(kind.rays.size(), threads, counters,
                        [&](std::size_t first, std::size_t last, TraversalCounters& sum) {
                          for (std::size_t ray = first; ray < last; ++ray) answers[ray] = ask(ray, sum);
                        });
  };
}

double t_of(const std::optional<dcem::TriangleHit>& hit) {
  return hit ? hit->t : none;
}

/// Many closest hits at a time, in blocks as the simulator asks for them: `ask(first ray, places, counters)`.
template <typename Ask>
Trace in_blocks(const RayKind& kind, unsigned threads, Ask ask) {
  const std::size_t rays = kind.rays.size(), sphere = kind.rays_a_sphere > 0 ? kind.rays_a_sphere : rays;
  const auto hits = std::make_shared<std::vector<std::optional<dcem::TriangleHit>>>(rays);
  return [=](std::vector<double>& answers, TraversalCounters& counters) {
    const std::span<std::optional<dcem::TriangleHit>> places(*hits);
    const auto trace = [&](std::size_t first, std::size_t last, TraversalCounters& sum) {
      while (first < last) {
        const std::size_t count = std::min({std::size_t{1024}, last - first, sphere - first % sphere});
        ask(first, places.subspan(first, count), sum);
        first += count;
      }
    };
    const double elapsed_ms = timed_pieces(rays, threads, counters, trace);
    std::transform(hits->begin(), hits->end(), answers.begin(), t_of);
    return elapsed_ms;
  };
}

/// One question after another.
Contender wide_contender(const std::string& name, const dcem::Scene& scene, const dcem::WideBuildSettings& settings) {
  const auto tree = std::make_shared<dcem::WideBvh>();
  const unsigned threads = settings.threads;
  return {name, [=, &scene] { tree->build(scene.triangle_view(), scene.triangle_boxes(), settings); },
          [=](const RayKind& kind) {
            return one_by_one(kind, threads, [tree, &kind](std::size_t ray, TraversalCounters& sum) {
              return t_of(tree->closest_hit(kind.rays[ray], {}, &sum));
            });
          },
          [=](const RayKind& kind) {
            return one_by_one(kind, threads, [tree, &kind](std::size_t ray, TraversalCounters& sum) {
              return tree->occluded(kind.rays[ray], {}, &sum) ? 1.0 : 0.0;
            });
          }};
}

/// What the simulator asks: closest hits a thousand at a time, those of a sphere as fans, and one leg after another
/// whether it is free; rays do not meet the facets that they leave.
Contender simulator_contender(const dcem::Scene& scene, unsigned threads) {
  struct Prepared {
    std::vector<dcem::LegFilter> filters;
    std::vector<dcem::RayQuery> queries;
    std::vector<Vec3> directions;
  };
  const auto tree = std::make_shared<dcem::WideBvh>();
  const auto prepare = [&scene](const RayKind& kind) {
    const auto prepared = std::make_shared<Prepared>();
    prepared->filters.reserve(kind.rays.size());
    for (std::size_t ray = 0; ray < kind.rays.size(); ++ray) {
      dcem::LegEnd start;
      if (!kind.from.empty()) start = {{&kind.from[ray], 1}, {&scene.facet(kind.from[ray]).plane, nullptr}};
      prepared->filters.emplace_back(scene, kind.rays[ray], start, dcem::IgnoredBodies{});
      prepared->queries.push_back({kind.rays[ray], prepared->filters.back().hit_filter()});
      prepared->directions.push_back(kind.rays[ray].direction);
    }
    return prepared;
  };
  const dcem::WideBuildSettings settings{.threads = threads};
  return {"wide, simulator", [=, &scene] { tree->build(scene.triangle_view(), scene.triangle_boxes(), settings); },
          [=](const RayKind& kind) {
            const auto prepared = prepare(kind);
            const bool is_launched = kind.rays_a_sphere > 0;
            return in_blocks(kind, threads, [=](std::size_t first, auto places, TraversalCounters& sum) {
              const std::span<const dcem::RayQuery> queries{&prepared->queries[first], places.size()};
              const std::span<const Vec3> directions{&prepared->directions[first], places.size()};
              if (!is_launched) return tree->closest_hits(queries, places, &sum);
              tree->closest_hits(dcem::RayFan{queries[0].ray.origin, directions, queries[0].filter}, places, &sum);
            });
          },
          [=](const RayKind& kind) {
            const auto prepared = prepare(kind);
            return one_by_one(kind, threads, [tree, prepared](std::size_t ray, TraversalCounters& sum) {
              const dcem::RayQuery& query = prepared->queries[ray];
              return tree->occluded(query.ray, query.filter, &sum) ? 1.0 : 0.0;
            });
          },
          [=, &scene](const RayKind& kind, bool closest) {
            const auto prepared = prepare(kind);
            dcem::BinaryIndex binary;
            binary.build(scene.triangle_view(), scene.triangle_boxes(), std::vector<std::uint32_t>{0});
            std::vector<double> answers;
            for (const dcem::RayQuery& query : prepared->queries) {
              answers.push_back(closest ? t_of(binary.closest_hit(query.ray, query.filter))
                                : binary.occluded(query.ray, query.filter) ? 1.0
                                                                           : 0.0);
            }
            return answers;
          }};
}

Contender binary_contender(const dcem::Scene& scene, unsigned threads) {
  const auto tree = std::make_shared<dcem::BinaryIndex>();
  const std::vector<std::uint32_t> all_at_first{0};
  return {"binary, double", [=, &scene] { tree->build(scene.triangle_view(), scene.triangle_boxes(), all_at_first); },
          [=](const RayKind& kind) {
            return one_by_one(kind, threads, [tree, &kind](std::size_t ray, TraversalCounters& sum) {
              return t_of(tree->closest_hit(kind.rays[ray], {}, &sum));
            });
          },
          [=](const RayKind& kind) {
            return one_by_one(kind, threads, [tree, &kind](std::size_t ray, TraversalCounters& sum) {
              return tree->occluded(kind.rays[ray], {}, &sum) ? 1.0 : 0.0;
            });
          }};
}

#if defined(DCEM_HAS_EMBREE)
using EmbreeTree = std::shared_ptr<std::unique_ptr<dcem::bench::EmbreeScene>>;

std::function<void()> embree_build(const EmbreeTree& tree, const dcem::TriangleView& mesh,
                                   const dcem::bench::EmbreeSettings& settings) {
  std::vector<dcem::Quad> quads;
  if (settings.quads) {
    dcem::detail::QuadBuilder(mesh, dcem::WideBuildSettings{}.pair_flatness)
        .append(0, static_cast<std::uint32_t>(mesh.size()), quads);
  }
  return [=] {
    *tree = std::make_unique<dcem::bench::EmbreeScene>(settings);
    (*tree)->attach((*tree)->add(mesh, quads));
    (*tree)->commit();
  };
}

/// Positions of a kind's rays in the order given, or in that of `RayOrder`.
std::vector<std::uint32_t> positions_of(const RayKind& kind, bool sorted) {
  std::vector<std::uint32_t> positions(kind.rays.size());
  std::iota(positions.begin(), positions.end(), 0U);
  dcem::RayOrder order;
  if (sorted) std::ranges::copy(order.sort(kind.rays), positions.begin());
  return positions;
}

/// One ray after another, in the order given or, `sorted`, in the best one.
Contender embree_contender(const std::string& name, const dcem::TriangleView& mesh,
                           const dcem::bench::EmbreeSettings& settings, bool sorted = false) {
  const auto tree = std::make_shared<std::unique_ptr<dcem::bench::EmbreeScene>>();
  const auto trace = [=](bool closest, const RayKind& kind) -> Trace {
    const auto positions = positions_of(kind, sorted);
    std::vector<RTCRayHit> prepared;
    for (const std::uint32_t ray : positions) prepared.push_back(dcem::bench::embree_query(kind.rays[ray]));
    return [=, threads = settings.threads](std::vector<double>& answers, TraversalCounters& counters) {
      std::vector<RTCRayHit> queries = prepared;
      const dcem::bench::EmbreeScene& scene = **tree;
      const double elapsed_ms =
          timed_pieces(queries.size(), threads, counters, [&](std::size_t first, std::size_t last, TraversalCounters&) {
            for (; first < last; ++first) {
              closest ? scene.intersect(queries[first]) : scene.occlude(queries[first].ray);
            }
          });
      for (std::size_t at = 0; at < queries.size(); ++at) {
        answers[positions[at]] = closest ? dcem::bench::t_of(queries[at]) : queries[at].ray.tfar < 0.0F ? 1.0 : 0.0;
      }
      return elapsed_ms;
    };
  };
  return {name, embree_build(tree, mesh, settings), [=](const RayKind& kind) { return trace(true, kind); },
          [=](const RayKind& kind) { return trace(false, kind); }};
}

/// Sixteen rays that follow one another at a time, said to be coherent.
Contender packet_contender(const dcem::TriangleView& mesh, unsigned threads) {
  const auto tree = std::make_shared<std::unique_ptr<dcem::bench::EmbreeScene>>();
  const auto trace = [=](bool closest, const RayKind& kind) -> Trace {
    const auto prepared = std::make_shared<std::vector<RTCRayHit16>>(dcem::bench::embree_packets(kind.rays));
    const std::size_t rays = kind.rays.size();
    return [=](std::vector<double>& answers, TraversalCounters& counters) {
      std::vector<RTCRayHit16> packets = *prepared;
      const dcem::bench::EmbreeScene& scene = **tree;
      const double elapsed_ms =
          timed_pieces(packets.size(), threads, counters, [&](std::size_t first, std::size_t last, TraversalCounters&) {
            for (; first < last; ++first) {
              closest ? scene.intersect(packets[first]) : scene.occlude(packets[first].ray);
            }
          });
      for (std::size_t ray = 0; ray < rays; ++ray) {
        const RTCRayHit16& packet = packets[ray / 16];
        answers[ray] = closest ? dcem::bench::t_of(packet, ray % 16) : packet.ray.tfar[ray % 16] < 0.0F ? 1.0 : 0.0;
      }
      return elapsed_ms;
    };
  };
  return {packet_name, embree_build(tree, mesh, {.threads = threads}),
          [=](const RayKind& kind) { return trace(true, kind); },
          [=](const RayKind& kind) { return trace(false, kind); }};
}
#endif

std::vector<Contender> contenders(const dcem::Scene& scene, unsigned threads) {
  using dcem::WideQuality;
  std::vector<Contender> all;
  all.push_back(simulator_contender(scene, threads));
  all.push_back(wide_contender("wide, one by one", scene, {.threads = threads}));
  all.push_back(wide_contender("wide, fast build", scene, {.threads = threads, .quality = WideQuality::fast}));
  all.push_back(wide_contender("wide, high quality", scene, {.threads = threads, .quality = WideQuality::high}));
#if defined(DCEM_HAS_EMBREE)
  const dcem::TriangleView mesh = scene.triangle_view();
  all.push_back(embree_contender(rival_name, mesh, {.threads = threads}));
  all.push_back(packet_contender(mesh, threads));
  all.push_back(embree_contender("embree robust sorted", mesh, {.threads = threads}, true));
  all.push_back(embree_contender("embree robust quads", mesh, {.quads = true, .threads = threads}));
  all.push_back(embree_contender("embree medium", mesh, {.robust = false, .threads = threads}));
  all.push_back(embree_contender("embree medium quads", mesh, {.robust = false, .quads = true, .threads = threads}));
#endif
  all.push_back(wide_contender("wide, triangles", scene, {.pair_flatness = -1.0, .threads = threads}));
  all.push_back(binary_contender(scene, threads));
  return all;
}

/// The rays of a picture from above, rays that leave surfaces in all directions, segments between points near the
/// ground, and spheres of rays that receivers at such points launch. All numbers are single-precision ones, so that
/// everybody gets the same.
std::vector<RayKind> ray_kinds(const dcem::Scene& scene, const dcem::Aabb<double>& bounds, std::size_t count) {
  const dcem::TriangleView mesh = scene.triangle_view();
  dcem::RandomStream random(3);
  std::vector<RayKind> kinds{{"primary", {}},
                             {"bounce", {}},
                             {"segment", {}},
                             {"sphere of 2000", {}, {}, 2000},
                             {"sphere of 20000", {}, {}, 20'000}};
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
    kinds[1].from.push_back(scene.facet_of_triangle(triangle));
    Vec3 way = dcem::bench::direction_on_sphere(random);
    way.z *= 0.2;
    const Vec3 from_m = as_float(dcem::bench::point_over(bounds, 0.5, 20.0, random));
    const Vec3 to_m = as_float(from_m + way * dcem::bench::between(random, 5.0, 150.0));
    kinds[2].rays.push_back(dcem::segment_between(from_m, to_m));
  }
  for (RayKind& kind : kinds) {
    while (kind.rays_a_sphere > 0 && kind.rays.size() < count) {
      const Vec3 from_m = as_float(dcem::bench::point_over(bounds, 1.0, 2.0, random));
      const dcem::Mat3 turned = dcem::random_rotation(random);
      for (const Vec3& direction : dcem::launch_directions(static_cast<std::uint32_t>(kind.rays_a_sphere))) {
        kind.rays.push_back({from_m, as_float(turned * direction)});
      }
    }
  }
  return kinds;
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
  std::vector<Trace> traces;
  for (const Contender& one : all) traces.push_back((closest_hit ? one.closest : one.occluded)(kind));
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t turn = 0; turn < all.size(); ++turn) {
      const std::size_t index = (round + turn) % all.size();
      Row& row = rows[index];
      row.answers.resize(kind.rays.size());
      row.counters = {};
      row.ms.push_back(traces[index](row.answers, row.counters));
    }
  }
  const double count = static_cast<double>(kind.rays.size());
  // Without Embree there is nothing to compare with but ourselves, and the cell stays empty.
  const auto median_ms = [&](const char* name) {
    const auto rival = std::find_if(all.begin(), all.end(), [&](const Contender& one) { return one.name == name; });
    return rival != all.end() ? dcem::median(rows[static_cast<std::size_t>(rival - all.begin())].ms) : 0.0;
  };
  const double rival_ms = median_ms(rival_name), packet_ms = median_ms(packet_name);
  bool same = true;
  for (std::size_t index = 0; index < all.size(); ++index) {
    const double ms = dcem::median(rows[index].ms);
    const std::size_t differences = count_differences(
        rows[index].answers, all[index].expected ? all[index].expected(kind, closest_hit) : rows.back().answers);
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
    packet_ms > 0.0 ? csv.number(packet_ms / ms, 3) : csv.empty();
    csv.number(count / ms / 1e3, 3);
    csv.number(dcem::median(all[index].build_ms), 2);
    csv.number(static_cast<double>(rows[index].counters.nodes_visited) / count, 2);
    csv.number(static_cast<double>(rows[index].counters.primitives_tested) / count, 2);
    csv.count(differences).hash(hash).print();
    std::fprintf(stderr, "%-14s %-8s %-8s %-22s %6.2f x %6.2f x  %7.2f Mrays/s  %zu differ\n", scene_name.c_str(),
                 kind.name.c_str(), closest_hit ? "closest" : "occluded", all[index].name.c_str(), rival_ms / ms,
                 packet_ms / ms, count / ms / 1e3, differences);
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
  const dcem::TriangleMesh scenery = dcem::bench::tiled(dcem::io::read_obj(file).mesh, options.copies);
  dcem::Scene scene;
  for (const std::string& name : scenery.material_names) scene.add_material({name, dcem::PerfectConductor{}});
  scene.set_scenery(scenery);
  const dcem::TriangleView mesh = scene.triangle_view();
  std::vector<Contender> all = contenders(scene, options.threads());
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
  for (const RayKind& kind : ray_kinds(scene, bounds, options.rays)) {
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
        "scene,triangles,threads,rays,query,tree,ratio_to_embree_robust,ratio_to_embree_packet,mrays_per_s,build_ms,"
        "nodes_per_ray,quads_per_ray,"
        "differences,hash");
    bool same = true;
    for (const std::string& file : options.files) same = bench(options, file) && same;
    return same;
  });
}
