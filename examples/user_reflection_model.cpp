/// A reflection model of one's own: every bounce loses 15 dB and turns the phase by π, whatever the angle.
///
/// A model is any type with `SurfaceResponse response(MaterialId, double cos_incidence) const`. The engine asks it at
/// each interaction; nothing else changes. This one is what NIST's Q-D realization software uses for its L-shaped room.
#include <cstdio>

#include "dcem/dcem.hpp"

namespace {

struct FixedLoss {
  double loss_db = 15.0;

  dcem::SurfaceResponse response(dcem::MaterialId, double) const {
    const double amplitude = dcem::db_to_amplitude_ratio(-loss_db);
    return {{-amplitude, -amplitude}, {0.0, 0.0}};  // exp(jπ) = −1 for both polarizations; nothing goes through
  }
};

}  // namespace

int main() {
  dcem::Scene scene;
  scene.add_material(
      {"wall", dcem::PerfectConductor{}});  // the name is needed; how it reflects is for FixedLoss to say
  scene.set_scenery(dcem::make_box({10.0, 6.0, 3.0}, "wall"));
  const dcem::Antenna both{0.0, {dcem::PolarizationKind::dual}};  // the power of a bounce, whatever the polarization
  scene.add_transmitter(dcem::device_at("access point", {-3.0, 1.0, 2.5}, 20.0, both));
  scene.add_receiver(dcem::device_at("laptop", {2.0, -1.5, 1.2}, 0.0, both));

  dcem::SimulationSettings settings;
  settings.frequency_hz = 60e9;
  settings.propagation.max_reflections = 2;
  dcem::Simulator simulator(std::move(scene), settings, FixedLoss{15.0});

  const dcem::FrameResult frame = simulator.advance_to(0.0);
  std::puts("kinds  length/m   gain/dB   of which bounces/dB");
  for (const dcem::PathContribution& path : frame.links.at(0).paths) {
    const double gain_db = dcem::power_ratio_to_db(path.power_ratio);
    const double spreading_db = -dcem::free_space_path_loss_db(path.path.length_m, settings.frequency_hz);
    std::printf("%-5s %9.3f %9.2f %9.2f\n", dcem::kinds(path.path).c_str(), path.path.length_m, gain_db,
                gain_db - spreading_db);
  }
}
