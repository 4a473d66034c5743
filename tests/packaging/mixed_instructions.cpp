// A program that is compiled for a newer processor than `dcem::engine`, as with -march=native, and brings the simulator
// as a template with a surface model of its own: the linker takes some functions from here and some from the library.
// What they hand to each other must look the same to both.
#include <cstdint>
#include <cstdio>
#include <utility>
#include <vector>

#include "dcem/core/instruction_set.hpp"
#include "dcem/sim/basic_simulator.hpp"
#include "dcem/sim/detail/material_table_of.hpp"
#include "dcem/sim/simulator.hpp"

namespace {

struct OwnSurface : dcem::MaterialTable {
  explicit OwnSurface(dcem::MaterialTable table) : MaterialTable(std::move(table)) {}
};

/// So many houses that paths are found from what both ends see.
dcem::Scene town() {
  dcem::TriangleMesh mesh;
  for (int house = 0; house < 49; ++house) {
    const double x_m = 20.0 * (house % 7), y_m = 20.0 * (house / 7);
    const dcem::Vec3 size_m(9.0 + house % 3, 8.0 + house % 4, 6.0 + house % 5);
    const dcem::TriangleMesh box = dcem::make_box(size_m, "concrete");
    const auto first = static_cast<std::uint32_t>(mesh.vertices_m.size());
    for (const dcem::Vec3& vertex_m : box.vertices_m) {
      mesh.vertices_m.push_back(vertex_m + dcem::Vec3(x_m, y_m, 0.0));
    }
    for (const auto& [corners, material] : box.triangles) {
      const auto& [a, b, c] = corners;
      mesh.triangles.push_back({{first + a, first + b, first + c}, material});
    }
  }
  mesh.material_names = {"concrete"};
  dcem::Scene scene;
  scene.add_material({"concrete", dcem::ItuMaterial{"concrete", {}}});
  scene.set_scenery(mesh);
  scene.add_transmitter(dcem::device_at("mast", {50.0, 51.0, 12.0}, 30.0));
  scene.add_receiver(dcem::device_at("street", {69.0, 31.0, 1.5}));
  return scene;
}

/// The powers of a link, and of a map, one after the other.
template <typename Simulator>
std::vector<double> powers_dbm(Simulator& simulator) {
  std::vector<double> powers_dbm;
  const auto add = [&](const dcem::LinkStatistics& of) { powers_dbm.push_back(of.power_dbm.value_or(-999.0)); };
  for (const dcem::LinkResult& link : simulator.advance_to(0.0).links) add(link.statistics);
  const dcem::ReceiverGrid grid{"streets", {48.0, 46.0, 1.5}, {3.0, 3.0}, {9, 5}, {}, {1, 1}};
  const std::vector<dcem::RadioMap> maps = simulator.radio_maps(grid);
  for (const dcem::RadioMapPoint& point : maps.at(0).points) add(point.statistics);
  return powers_dbm;
}

}  // namespace

int main() {
  if (!is_supported(dcem::compiled_instruction_set)) {
    std::puts("this processor lacks the instructions that the test is compiled for");
    return 77;
  }
  dcem::SimulationSettings settings{.frequency_hz = 28e9};
  settings.propagation.max_transmissions = 0;
  const dcem::Scene scene = town();
  dcem::Simulator compiled(scene, settings);
  dcem::BasicSimulator<OwnSurface, dcem::WideIndex> own(scene, settings,
                                                        OwnSurface(dcem::detail::material_table_of(scene, settings)));
  const std::vector<double> one_dbm = powers_dbm(compiled), other_dbm = powers_dbm(own);
  std::printf("%zu powers, the first %.9f dBm\n", one_dbm.size(), one_dbm.front());
  return compiled.plan().joined == 3 && one_dbm.size() == 46 && one_dbm.front() > -200.0 && one_dbm == other_dbm ? 0
                                                                                                                 : 1;
}
