/// Times the way from an OBJ file to a tree, step by step.
///
///   bench_load ROUNDS FILE.obj...
///
/// Files take turns within a round. One CSV row per file: medians over the rounds, what was found, and a hash of all
/// facets. Rounds whose hashes differ are an error: exit 1 and no row.
#include <algorithm>
#include <bit>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/bench_program.hpp"
#include "dcem/accel/bvh.hpp"
#include "dcem/core/random.hpp"
#include "dcem/core/statistics.hpp"
#include "dcem/geometry/surfaces/build_surface_mesh.hpp"
#include "dcem/geometry/surfaces/facet_builder.hpp"
#include "dcem/geometry/surfaces/wedge_builder.hpp"
#include "dcem/io/obj_reader.hpp"

namespace {

using dcem::bench::Stopwatch;

struct Row {
  std::string file;
  std::vector<double> parse_ms{}, weld_ms{}, facets_ms{}, tree_ms{};  ///< one entry per round
  dcem::SurfaceReport report{};
  std::size_t triangles = 0, facets = 0, nodes = 0;
  std::uint64_t hash = 0;
};

std::uint64_t hash_of(const dcem::Vec3& point, std::uint64_t hash) {
  return dcem::hash_values(hash, std::bit_cast<std::uint64_t>(point.x), std::bit_cast<std::uint64_t>(point.y),
                           std::bit_cast<std::uint64_t>(point.z));
}

/// Of materials, planes, hulls and triangles.
std::uint64_t hash_of(const dcem::SurfaceMesh& mesh) {
  std::uint64_t hash = 0;
  for (const dcem::Facet& facet : mesh.facets) {
    hash = dcem::hash_text(mesh.material_names[facet.material], hash);
    hash = hash_of(facet.plane.normal, dcem::hash_values(hash, facet.triangle_count, facet.hull_point_count));
  }
  for (const dcem::Vec3& point : mesh.hull_points_m) hash = hash_of(point, hash);
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t vertex : triangle) hash = hash_of(mesh.vertices_m[vertex], hash);
  }
  return hash;
}

std::vector<dcem::Aabb<double>> boxes_of(const dcem::SurfaceMesh& mesh) {
  std::vector<dcem::Aabb<double>> boxes(mesh.triangles.size());
  for (std::size_t triangle = 0; triangle < boxes.size(); ++triangle) {
    for (const std::uint32_t vertex : mesh.triangles[triangle]) boxes[triangle].extend(mesh.vertices_m[vertex]);
  }
  return boxes;
}

void build_tree(const dcem::SurfaceMesh& mesh, Row& row) {
  const std::vector<dcem::Aabb<double>> boxes = boxes_of(mesh);
  const Stopwatch watch;
  dcem::Bvh<double> tree;
  tree.build(boxes);
  row.tree_ms.push_back(watch.elapsed_ms());
  row.nodes = tree.nodes().size();
}

/// False where the facets are not those of the rounds before.
bool load(Row& row) {
  const Stopwatch parse_watch;
  const dcem::TriangleMesh read = dcem::io::read_obj(row.file).mesh;
  row.parse_ms.push_back(parse_watch.elapsed_ms());
  const dcem::SurfaceSettings settings;
  const Stopwatch weld_watch;
  dcem::CleanMesh clean = dcem::clean_mesh(read, settings);
  row.weld_ms.push_back(weld_watch.elapsed_ms());
  // The second half of build_surface_mesh, which has no name of its own outside.
  const Stopwatch facets_watch;
  const dcem::SurfaceMesh mesh = dcem::detail::FacetBuilder(std::move(clean), settings).build();
  row.facets_ms.push_back(facets_watch.elapsed_ms());
  build_tree(mesh, row);
  const std::uint64_t hash = hash_of(mesh);
  if (row.parse_ms.size() > 1 && hash != row.hash) {
    std::fprintf(stderr, "%s: facets differ between rounds\n", row.file.c_str());
    return false;
  }
  row.hash = hash;
  row.report = mesh.report;
  row.triangles = mesh.triangles.size();
  row.facets = mesh.facets.size();
  return true;
}

void print(const Row& row) {
  using dcem::median;
  dcem::bench::CsvRow csv;
  csv.text(std::filesystem::path(row.file).stem().string()).count(row.report.triangles_read).count(row.triangles);
  csv.count(row.report.vertices_read).count(row.report.vertices_welded).count(row.facets).count(row.nodes);
  csv.number(median(row.parse_ms), 3).number(median(row.weld_ms), 3).number(median(row.facets_ms), 3);
  csv.number(median(row.tree_ms), 3).hash(row.hash).print();
}

bool bench(const std::vector<std::string>& files, int rounds) {
  std::vector<Row> rows;
  for (const std::string& file : files) rows.push_back({file});
  for (int round = 0; round < rounds; ++round) {
    if (!std::all_of(rows.begin(), rows.end(), load)) return false;
  }
  std::puts(
      "scene,triangles_read,triangles,vertices_read,vertices_welded,facets,nodes,parse_ms,weld_ms,facets_ms,tree_ms,"
      "hash");
  for (const Row& row : rows) print(row);
  return true;
}

}  // namespace

int main(int count, char** arguments) {
  int rounds = 1;
  std::vector<std::string> files;
  CLI::App app("Times the way from an OBJ file to a tree");
  app.add_option("ROUNDS", rounds, "how often each file is loaded")->required()->check(CLI::Range(1, 1'000'000));
  app.add_option("FILE", files, "OBJ files")->required();
  return dcem::bench::run_program(app, count, arguments, [&] { return bench(files, rounds); });
}
