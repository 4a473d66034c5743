/// The first path in ten lines: two devices over a concrete ground.
#include <cstdio>

#include "dcem/dcem.hpp"

int main() {
  dcem::Scene scene;
  scene.add_material({"ground", dcem::ItuMaterial{"concrete", std::nullopt}});
  dcem::TriangleMesh ground;
  dcem::add_quad(ground, {dcem::Vec3(-50, -50, 0), {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}}, "ground");
  scene.set_scenery(ground);
  scene.add_transmitter(dcem::device_at("mast", {0.0, 0.0, 10.0}, 30.0));
  scene.add_receiver(dcem::device_at("phone", {30.0, 4.0, 1.5}));
  dcem::Simulator simulator(scene, {.frequency_hz = 28e9});
  const dcem::FrameResult frame = simulator.advance_to(0.0);
  for (const dcem::PathContribution& path : frame.links.at(0).paths) {
    std::printf("%-3s %8.4f m %9.3f ns %8.2f dB\n", dcem::kinds(path.path).c_str(), path.path.length_m,
                path.delay_s * 1e9, dcem::power_ratio_to_db(path.power_ratio));
  }
}
