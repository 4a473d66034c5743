/// A reflection model of one's own: every bounce loses 15 dB and turns the phase by π, whatever the angle. It stands
/// beside built-in materials in one scene. This one is what NIST's Q-D realization software uses for its L-shaped room.
#include <cstdio>

#include "dcem/dcem.hpp"
#include "dcem/em/surface/user_surface.hpp"

namespace {

class FixedLoss : public dcem::UserSurfaceModel {
 public:
  explicit FixedLoss(double loss_db) : amplitude_(dcem::db_to_amplitude_ratio(-loss_db)) {}

  dcem::SurfaceResponse response(double, double) const override {
    return {{-amplitude_, -amplitude_}, {0.0, 0.0}};  // exp(jπ) = −1 for both polarizations; nothing goes through
  }

 private:
  double amplitude_;
};

}  // namespace

int main() {
  dcem::Scene scene;
  scene.add_material({"wall", dcem::user_surface(FixedLoss(15.0))});
  scene.set_scenery(dcem::make_box({10.0, 6.0, 3.0}, "wall"));
  const dcem::Antenna both{0.0, {dcem::PolarizationKind::dual}};  // the power of a bounce, whatever the polarization
  scene.add_transmitter(dcem::device_at("access point", {-3.0, 1.0, 2.5}, 20.0, both));
  scene.add_receiver(dcem::device_at("laptop", {2.0, -1.5, 1.2}, 0.0, both));

  dcem::SimulationSettings settings;
  settings.frequency_hz = 60e9;
  settings.propagation.max_reflections = 2;
  dcem::Simulator simulator(std::move(scene), settings);

  const dcem::FrameResult frame = simulator.advance_to(0.0);
  std::puts("kinds  length/m   gain/dB   of which bounces/dB");
  for (const dcem::PathContribution& path : frame.links.at(0).paths) {
    const double gain_db = dcem::power_ratio_to_db(path.power_ratio);
    const double spreading_db = -dcem::free_space_path_loss_db(path.path.length_m, settings.frequency_hz);
    std::printf("%-5s %9.3f %9.2f %9.2f\n", dcem::kinds(path.path).c_str(), path.path.length_m, gain_db,
                gain_db - spreading_db);
  }
}
