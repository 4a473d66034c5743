/// A multipath-lifetime map: how far a receiver, the mast and all else may move before any path between the two appears
/// or vanishes, at each point of some streets. A model of the channel that keeps the paths of a frame, and only follows
/// their lengths, is right for so long; where the map is dark they have to be looked for again at once.
///
/// Writes lifetime_map.png into the current folder: the picture of docs/design/lifetime.md.
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "dcem/dcem.hpp"
#include "dcem/io/heat_map.hpp"
#include "dcem/io/map_writer.hpp"
#include "dcem/io/obj_reader.hpp"
#include "dcem/sim/simulator.hpp"

namespace {

constexpr std::size_t columns = 66, rows = 48;
constexpr double spacing_m = 2.0, left_m = 0.0, bottom_m = -30.0, height_m = 1.5;
const dcem::Vec3 mast_m{68.5, 34.2, 20.3};

dcem::Vec3 point_m(std::size_t cell) {
  return {left_m + spacing_m * static_cast<double>(cell % columns),
          bottom_m + spacing_m * static_cast<double>(cell / columns), height_m};
}

/// The town without its cars, all of it a perfect mirror: what paths there are does not depend on materials that block.
dcem::Scene town() {
  const dcem::TriangleMesh mesh = dcem::io::read_obj(DCEM_DATA_DIR "/town.obj").mesh;
  dcem::Scene scene;
  for (const std::string& name : mesh.material_names) scene.add_material({name, dcem::PerfectConductor{}});
  scene.set_scenery(mesh);
  scene.add_transmitter(dcem::device_at("mast", mast_m, 37.0));
  return scene;
}

dcem::SimulationSettings settings() {
  dcem::SimulationSettings settings;
  settings.propagation.max_transmissions = 0;
  settings.propagation.max_diffractions = 0;  // over walls alone the map shows where they end
  settings.propagation.valid_until_limit_m = 1.0;
  return settings;
}

}  // namespace

int main() {
  // Points inside houses get no receiver.
  dcem::Scene scene = town();
  const dcem::Simulator empty(scene, settings());
  std::vector<char> inside(columns * rows);
  for (std::size_t cell = 0; cell < inside.size(); ++cell) {
    inside[cell] = empty.shells_at(point_m(cell)).empty() ? 0 : 1;
    if (inside[cell] == 0) scene.add_receiver(dcem::device_at(std::to_string(cell), point_m(cell)));
  }
  dcem::Simulator simulator(scene, settings());
  const dcem::FrameResult frame = simulator.advance_to(0.0);

  dcem::io::HeatMap map;
  map.title = "Until a path appears or vanishes";
  map.label = "proved distance";
  map.unit = "cm";
  map.no_value_label = "no receiver";
  map.origin_x_m = left_m;
  map.origin_y_m = bottom_m;
  map.spacing_x_m = map.spacing_y_m = spacing_m;
  map.columns = columns;
  map.rows = rows;
  map.values.assign(columns * rows, 1e300);
  map.hatched = inside;
  map.walls_m = dcem::io::walls_at_height_m(scene, height_m);
  map.transmitters = {{mast_m.x, mast_m.y, "mast"}};
  map.range = dcem::io::ValueRange{0.0, 30.0};
  std::vector<double> sorted_m;
  for (const dcem::LinkResult& link : frame.links) {
    const std::size_t cell = std::stoul(scene.receivers()[link.receiver].id);
    map.values[cell] = 100.0 * link.valid_until_m.value();
    sorted_m.push_back(link.valid_until_m.value());
  }
  dcem::io::write_heat_map(map, "lifetime_map.png");

  std::sort(sorted_m.begin(), sorted_m.end());
  const auto quantile_cm = [&](double share) {
    return 100.0 * sorted_m[static_cast<std::size_t>(share * static_cast<double>(sorted_m.size() - 1))];
  };
  std::printf("%zu points, %.1f paths each; quartiles %.2f, %.2f and %.2f cm, most %.1f cm\n", sorted_m.size(),
              static_cast<double>(frame.work.paths) / static_cast<double>(sorted_m.size()), quantile_cm(0.25),
              quantile_cm(0.5), quantile_cm(0.75), quantile_cm(1.0));
}
