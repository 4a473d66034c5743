/// Refit or rebuild? 300 cars drive through the town for 20 s while three trees follow them: one is built anew in every
/// frame, one is only refitted, one decides by itself. All three give the same hits; what differs is the work. Twice:
/// with the wide tree, which the simulator uses, and with the binary tree. Prints tables, draws
/// refit_or_rebuild_wide.svg and refit_or_rebuild.svg.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "dcem/accel/binary_index.hpp"
#include "dcem/accel/wide_index.hpp"
#include "dcem/dcem.hpp"
#include "dcem/io/line_chart.hpp"
#include "dcem/io/obj_reader.hpp"

namespace {

constexpr std::size_t car_count = 300, frame_count = 200, ray_count = 500;
constexpr double step_s = 0.1, fastest_mps = 14.0;

double between(dcem::RandomStream& random, double low, double high) {
  return low + random.uniform() * (high - low);
}

dcem::Vec3 point_in(const dcem::Aabb<double>& box, double low_m, double high_m, dcem::RandomStream& random) {
  const double x = between(random, box.min.x, box.max.x), y = between(random, box.min.y, box.max.y);
  return {x, y, between(random, low_m, high_m)};
}

/// From somewhere towards somewhere else, as far as it goes at a speed of up to 14 m/s.
dcem::Motion straight_drive(const dcem::Aabb<double>& town, dcem::RandomStream& random) {
  const double duration_s = step_s * frame_count;
  const dcem::Vec3 start_m = point_in(town, 0.0, 0.0, random), goal_m = point_in(town, 0.0, 0.0, random);
  const double way_m = std::min(glm::distance(start_m, goal_m), between(random, 0.0, fastest_mps) * duration_s);
  const dcem::Vec3 heading = glm::normalize(goal_m - start_m);
  const double yaw_rad = std::atan2(heading.y, heading.x);
  return dcem::WaypointMotion{{{0.0, {start_m, yaw_rad}}, {duration_s, {start_m + way_m * heading, yaw_rad}}}};
}

dcem::Scene town_with_cars(dcem::RandomStream& random) {
  dcem::Scene scene;
  const dcem::TriangleMesh town = dcem::io::read_obj(DCEM_DATA_DIR "/town.obj").mesh;
  // Rays stop at any surface here: what it is made of does not matter.
  for (const std::string& name : town.material_names) scene.add_material({name, dcem::PerfectConductor{}});
  scene.add_material({"car", dcem::PerfectConductor{}});
  scene.set_scenery(town);
  dcem::Aabb<double> bounds;
  for (const dcem::Vec3& vertex : scene.vertices_m()) bounds.extend(vertex);
  for (std::size_t car = 0; car < car_count; ++car) {
    scene.add_object("car" + std::to_string(car), dcem::make_box({4.4, 1.8, 1.5}, "car"),
                     straight_drive(bounds, random));
  }
  return scene;
}

/// Rays from a little above the ground in all directions, as receivers in the streets send them.
std::vector<dcem::RayQuery> rays_over(const dcem::Aabb<double>& bounds, dcem::RandomStream& random) {
  std::vector<dcem::RayQuery> rays;
  for (std::size_t ray = 0; ray < ray_count; ++ray) {
    const dcem::Vec3 origin_m = point_in(bounds, 0.5, 3.0, random);
    const double z = between(random, -1.0, 1.0), azimuth_rad = between(random, -dcem::pi, dcem::pi);
    const double level = std::sqrt(1.0 - z * z);
    rays.push_back({{origin_m, {level * std::cos(azimuth_rad), level * std::sin(azimuth_rad), z}}});
  }
  return rays;
}

/// One policy, and what it has cost so far.
struct Contender {
  std::string name;
  double update_s = 0.0;
  std::uint64_t nodes_refit = 0, nodes_rebuilt = 0, subtrees_rebuilt = 0;
  std::vector<double> steps_per_ray{}, sah_cost{};  ///< one entry per frame
};

template <dcem::SpatialIndex Index>
void follow(Contender& contender, Index& index, const dcem::Scene& scene, const std::vector<std::uint32_t>& moved) {
  const auto start = std::chrono::steady_clock::now();
  const dcem::TreeUpdateReport report = index.update(scene.triangle_view(), scene.triangle_boxes(), moved);
  contender.update_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  contender.nodes_refit += report.nodes_refit;
  contender.nodes_rebuilt += report.nodes_rebuilt;
  contender.subtrees_rebuilt += report.subtrees_rebuilt;
  contender.sah_cost.push_back(report.sah_cost);
}

using Hits = std::vector<std::optional<dcem::TriangleHit>>;

template <dcem::SpatialIndex Index>
Hits trace(Contender& contender, const Index& index, const std::vector<dcem::RayQuery>& rays) {
  dcem::TraversalCounters counters;
  Hits hits(rays.size());
  index.closest_hits(rays, hits, &counters);
  contender.steps_per_ray.push_back(static_cast<double>(counters.nodes_visited) / static_cast<double>(rays.size()));
  return hits;
}

void print(const std::vector<Contender>& contenders) {
  std::puts("                update  nodes a frame   subtrees   steps per ray    SAH cost, last frame");
  std::puts("policy              ms    refit  rebuilt  rebuilt    first    last    over a new tree's");
  for (const Contender& contender : contenders) {
    const double frames = static_cast<double>(frame_count);
    std::printf("%-15s %6.2f %8.0f %8.0f %8llu %8.1f %7.1f %12.3f\n", contender.name.c_str(),
                1e3 * contender.update_s / frames, static_cast<double>(contender.nodes_refit) / frames,
                static_cast<double>(contender.nodes_rebuilt) / frames,
                static_cast<unsigned long long>(contender.subtrees_rebuilt), contender.steps_per_ray.front(),
                contender.steps_per_ray.back(), contender.sah_cost.back() / contenders.front().sah_cost.back());
  }
}

/// The first contender has a new tree in every frame: it is what the others are compared with.
void draw(const std::vector<Contender>& contenders, const char* file) {
  dcem::io::LineChart steps, cost;
  steps.title = "300 cars in the town: nodes visited by a ray";
  cost.title = "SAH cost of the tree over that of a new tree";
  steps.y_label = "steps per ray";
  cost.y_label = "ratio";
  steps.y_scale = cost.y_scale = dcem::io::ChartScale::linear_from_zero;
  std::vector<double> time_s;
  for (std::size_t frame = 0; frame < frame_count; ++frame) time_s.push_back(step_s * static_cast<double>(frame));
  for (const Contender& contender : contenders) {
    steps.series.push_back({contender.name, time_s, contender.steps_per_ray});
    std::vector<double> ratio;
    for (std::size_t frame = 0; frame < frame_count; ++frame) {
      ratio.push_back(contender.sah_cost[frame] / contenders.front().sah_cost[frame]);
    }
    cost.series.push_back({contender.name, time_s, std::move(ratio)});
  }
  const std::vector<dcem::io::LineChart> charts{steps, cost};
  dcem::io::write_line_charts(charts, file);
}

/// The drive with one kind of tree under three policies; the first has a new tree in every frame. Empty where hits
/// differ.
template <dcem::SpatialIndex Index>
std::vector<Contender> drive(dcem::Scene scene, const std::vector<dcem::RayQuery>& rays) {
  std::vector<Contender> contenders{{"rebuild always"}, {"refit only"}, {"adaptive"}};
  std::vector<Index> indices;
  for (const auto policy :
       {dcem::TreePolicy::rebuild_always, dcem::TreePolicy::refit_only, dcem::TreePolicy::adaptive}) {
    dcem::WideTreeSettings settings;
    settings.policy = policy;
    indices.emplace_back(settings).build(scene.triangle_view(), scene.triangle_boxes(), scene.first_triangles());
  }
  for (std::size_t frame = 0; frame < frame_count; ++frame) {
    std::vector<std::uint32_t> moved;
    for (const dcem::BodyId body : scene.apply(scene.frame_at(step_s * static_cast<double>(frame), frame)).moved) {
      const auto [first, last] = scene.triangle_range(body);
      for (std::uint32_t triangle = first; triangle < last; ++triangle) moved.push_back(triangle);
    }
    Hits expected;
    for (std::size_t each = 0; each < contenders.size(); ++each) {
      follow(contenders[each], indices[each], scene, moved);
      Hits hits = trace(contenders[each], indices[each], rays);
      if (expected.empty()) expected = hits;
      if (hits == expected) continue;
      std::printf("frame %zu: %s gives other hits\n", frame, contenders[each].name.c_str());
      return {};
    }
  }
  return contenders;
}

}  // namespace

int main() {
  dcem::RandomStream random(2026);
  const dcem::Scene scene = town_with_cars(random);
  dcem::Aabb<double> bounds;
  for (const dcem::Aabb<double>& box : scene.triangle_boxes()) bounds.extend(box);
  const std::vector<dcem::RayQuery> rays = rays_over(bounds, random);
  const std::vector<Contender> wide = drive<dcem::WideIndex>(scene, rays);
  const std::vector<Contender> binary = drive<dcem::BinaryIndex>(scene, rays);
  if (wide.empty() || binary.empty()) return 1;
  std::puts("The wide tree, eight children a node:");
  print(wide);
  draw(wide, "refit_or_rebuild_wide.svg");
  std::puts("\nThe binary tree:");
  print(binary);
  draw(binary, "refit_or_rebuild.svg");
}
