/// A large-scale path loss of one's own: two slopes, the second one steeper from a break point on, as beside a street.
#include <cmath>
#include <cstdio>

#include "dcem/dcem.hpp"

namespace {

struct TwoSlopes {
  double break_m = 100.0;
  double further_db_per_decade = 20.0;

  /// A real factor on the field, beside free space, by the whole length of a path.
  double excess_amplitude(double total_length_m) const {
    if (total_length_m <= break_m) return 1.0;
    return dcem::db_to_amplitude_ratio(-further_db_per_decade * std::log10(total_length_m / break_m));
  }
};

}  // namespace

int main() {
  dcem::Scene scene;
  scene.add_transmitter(dcem::device_at("mast", {0.0, 0.0, 10.0}, 30.0));
  for (const double distance_m : {25.0, 50.0, 100.0, 200.0, 400.0}) {
    scene.add_receiver(dcem::device_at(std::to_string(static_cast<int>(distance_m)) + " m", {distance_m, 0.0, 10.0}));
  }
  dcem::SimulationSettings settings{.frequency_hz = 5.9e9};
  settings.propagation.path_loss.model = dcem::UserPathLoss(TwoSlopes{});
  dcem::Simulator simulator(std::move(scene), settings);
  const dcem::FrameResult frame = simulator.advance_to(0.0);
  std::puts("distance   gain/dB   beside free space/dB");
  for (const dcem::LinkResult& link : frame.links) {
    const dcem::PathContribution& path = link.paths.at(0);
    const double gain_db = dcem::power_ratio_to_db(path.power_ratio);
    std::printf("%-8s %9.2f %9.2f\n", simulator.scene().receivers()[link.receiver].id.c_str(), gain_db,
                gain_db + dcem::free_space_path_loss_db(path.path.length_m, settings.frequency_hz));
  }
}
