/// An antenna of one's own: a short dipole along x, whose polarization turns with the direction, which no fixed Jones
/// vector can say. Field: √1.5 · (x̂ − (x̂·k) k), in (θ̂, φ̂) of the antenna's axes.
#include <cmath>
#include <cstdio>

#include "dcem/dcem.hpp"

namespace {

class DipoleAlongX : public dcem::UserPatternModel {
 public:
  dcem::JonesVector field(const dcem::Vec3& direction, std::size_t) const override {
    const dcem::Vec3 theta = dcem::theta_hat(direction), phi = dcem::phi_hat(direction);
    return {std::sqrt(1.5) * theta.x, std::sqrt(1.5) * phi.x};  // x̂ has no other components across k
  }
  double peak_power_gain() const override { return 1.5; }
};

}  // namespace

int main() {
  dcem::Scene scene;
  dcem::Antenna dipole;
  dipole.pattern = dcem::user_pattern(DipoleAlongX{});
  scene.add_transmitter(dcem::device_at("dipole", {0.0, 0.0, 10.0}, 30.0, dipole));
  dcem::Antenna upright, level;  // built-in ones, to receive
  level.polarization.kind = dcem::PolarizationKind::horizontal;
  for (int step = 0; step <= 6; ++step) {
    const double azimuth_rad = dcem::degrees_to_radians(15.0 * step);
    const dcem::Vec3 place_m(50.0 * std::cos(azimuth_rad), 50.0 * std::sin(azimuth_rad), 25.0);
    scene.add_receiver(dcem::device_at("V" + std::to_string(15 * step), place_m, 0.0, upright));
    scene.add_receiver(dcem::device_at("H" + std::to_string(15 * step), place_m, 0.0, level));
  }
  dcem::Simulator simulator(std::move(scene), {.frequency_hz = 3.5e9});
  const dcem::FrameResult frame = simulator.advance_to(0.0);
  std::puts("receiver   gain/dB");
  for (const dcem::LinkResult& link : frame.links) {
    const std::string& id = simulator.scene().receivers()[link.receiver].id;
    std::printf("%-8s %9.2f\n", id.c_str(), dcem::power_ratio_to_db(link.paths.at(0).power_ratio));
  }
}
