#pragma once
/// From the geometry of a path to its field: transfer matrix, power, delay, angles, Doppler.
///
/// Stateless: nothing is remembered from path to path or from frame to frame, so no gain can be stale.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/em/antenna/antenna.hpp"
#include "dcem/em/antenna/polarization.hpp"
#include "dcem/em/medium/path_loss.hpp"
#include "dcem/em/surface/material_table.hpp"
#include "dcem/field/array_channel.hpp"
#include "dcem/field/diffraction_chain.hpp"
#include "dcem/field/field_carrier.hpp"
#include "dcem/field/medium_loss.hpp"
#include "dcem/field/path_contribution.hpp"
#include "dcem/field/radio_end.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// exp(−jkL). The whole wavelengths are taken off before the angle is formed, so the phase keeps its digits at any
/// length.
inline Complex propagation_phasor(double length_m, double frequency_hz) {
  const double cycles = length_m * (frequency_hz / speed_of_light_mps);
  return unit_phasor(-2.0 * pi * (cycles - std::floor(cycles)));
}

template <SurfaceModel Surface = MaterialTable, PathLossModel Loss = AnyPathLoss>
class FieldEvaluator {
 public:
  FieldEvaluator(const Scene& scene, const Surface& surface, Loss loss, double frequency_hz,
                 const DiffractionModel& diffraction = {}, MediumLoss medium = {})
      : scene_(scene),
        surface_(surface),
        loss_(std::move(loss)),
        frequency_hz_(frequency_hz),
        diffraction_(diffraction),
        medium_(std::move(medium)) {}

  /// The field of a path between two ends.
  PathContribution evaluate(Path path, const RadioEnd& transmitter, const RadioEnd& receiver) const;

 private:
  /// Unit propagation directions of the legs, from the transmitter on: one more than there are interactions.
  static std::vector<Vec3> directions(const Path& path, const Vec3& from_m, const Vec3& to_m);

  /// What arrives along `received` of unit fields along `sent`: all coefficients and spreading, in 1/m, without phase.
  ComplexMatrix2 spread(const Path& path, const std::vector<Vec3>& directions, const Vec3& from_m, const Vec3& to_m,
                        const std::array<Vec3, 2>& sent, const std::array<Vec3, 2>& received) const;

  ComplexMatrix2 transfer(const Path& path, const std::vector<Vec3>& directions, const Vec3& from_m,
                          const Vec3& to_m) const;

  /// First-order Doppler shift: f = [v_tx·k_0 − v_rx·k_N + Σ v_i·(k_i − k_(i−1))]/λ, v_i the velocity of the touched
  /// body at the point of interaction. Motion within a mirror's plane drops out, as it must.
  double doppler_hz(const Path& path, const std::vector<Vec3>& directions, const RadioEnd& transmitter,
                    const RadioEnd& receiver) const;

  const Scene& scene_;
  const Surface& surface_;
  Loss loss_;
  double frequency_hz_;
  DiffractionModel diffraction_;
  MediumLoss medium_;
};

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline Direction direction_of(const Vec3& unit) {
  return {azimuth_rad(unit), zenith_rad(unit)};
}

/// The fields of an antenna's ports towards a direction; of an antenna with one port the first alone.
inline std::array<JonesVector, 2> port_fields(const RadioEnd& end, const Vec3& direction) {
  std::array<JonesVector, 2> fields{};
  for (std::size_t port = 0; port < end.antenna.port_count(); ++port) {
    fields[port] = end.antenna.port_jones(direction, port, end.rotation);
  }
  return fields;
}

/// Fills ports, amplitude, power and, where an end is an array, the channel from the transfer matrix and the two
/// antennas, which are turned as the ends say.
inline void apply_antennas(PathContribution& contribution, const RadioEnd& transmitter, const Vec3& departure,
                           const RadioEnd& receiver, const Vec3& arrival) {
  const Antenna &transmit = transmitter.antenna, &receive = receiver.antenna;
  const std::array<JonesVector, 2> sent = port_fields(transmitter, departure), heard = port_fields(receiver, arrival);
  contribution.transmit_ports = static_cast<int>(transmit.port_count());
  for (std::size_t in = 0; in < transmit.port_count(); ++in) {
    for (std::size_t out = 0; out < receive.port_count(); ++out) {
      contribution.ports(out, in) = port_coupling(heard[out], contribution.transfer, sent[in]);
    }
  }
  contribution.power_ratio = norm_squared(contribution.ports) / contribution.transmit_ports;
  contribution.has_amplitude = !transmit.is_dual() && !receive.is_dual();
  contribution.amplitude = contribution.has_amplitude ? contribution.ports(0, 0) : Complex{};
  if (!has_array(transmitter, receiver)) return;
  contribution.channel = plane_wave_channel(contribution.ports, transmitter, departure, receiver, arrival);
}

}  // namespace detail

template <SurfaceModel Surface, PathLossModel Loss>
std::vector<Vec3> FieldEvaluator<Surface, Loss>::directions(const Path& path, const Vec3& from_m, const Vec3& to_m) {
  // A sheet bends nothing: legs between reflections are straight, so all their parts share one direction to the last
  // bit.
  std::vector<Vec3> result(path.interactions.size() + 1);
  Vec3 start_m = from_m;
  std::size_t first = 0;
  for (std::size_t index = 0; index <= path.interactions.size(); ++index) {
    const bool last = index == path.interactions.size();
    if (!last && path.interactions[index].kind == InteractionKind::transmission) continue;
    const Vec3& end_m = last ? to_m : path.interactions[index].point_m;
    const Vec3 direction = glm::normalize(end_m - start_m);
    for (; first <= index; ++first) result[first] = direction;
    start_m = end_m;
  }
  return result;
}

template <SurfaceModel Surface, PathLossModel Loss>
ComplexMatrix2 FieldEvaluator<Surface, Loss>::spread(const Path& path, const std::vector<Vec3>& directions,
                                                     const Vec3& from_m, const Vec3& to_m,
                                                     const std::array<Vec3, 2>& sent,
                                                     const std::array<Vec3, 2>& received) const {
  const bool diffracted = std::any_of(path.interactions.begin(), path.interactions.end(),
                                      [](const Interaction& one) { return one.kind == InteractionKind::diffraction; });
  if (diffracted) {
    const double wave_number_rad_per_m = 2.0 * pi * frequency_hz_ / speed_of_light_mps;
    return DiffractionChain<Surface>(scene_, surface_, diffraction_, path, directions, from_m, to_m,
                                     wave_number_rad_per_m)
        .transfer(sent, received);
  }
  const FieldCarrier<Surface> carrier(scene_, surface_, path, directions);
  const auto carried =
      carrier.carry(std::array{ComplexVector3(sent[0]), ComplexVector3(sent[1])}, 0, path.interactions.size());
  ComplexMatrix2 matrix;
  for (std::size_t in = 0; in < 2; ++in) {
    for (std::size_t out = 0; out < 2; ++out)
      matrix(out, in) = Complex(1.0 / path.length_m) * dot(carried[in], received[out]);
  }
  return matrix;
}

template <SurfaceModel Surface, PathLossModel Loss>
ComplexMatrix2 FieldEvaluator<Surface, Loss>::transfer(const Path& path, const std::vector<Vec3>& directions,
                                                       const Vec3& from_m, const Vec3& to_m) const {
  const Vec3 departure = directions.front(), arrival = -directions.back();
  const double wavelength_m = speed_of_light_mps / frequency_hz_;
  const double amplitude_m = wavelength_m / (4.0 * pi) * loss_.excess_amplitude(path.length_m);
  const std::array<Vec3, 2> sent{theta_hat(departure), phi_hat(departure)};
  const std::array<Vec3, 2> received{theta_hat(arrival), phi_hat(arrival)};
  return (amplitude_m * propagation_phasor(path.length_m, frequency_hz_)) *
         spread(path, directions, from_m, to_m, sent, received);
}

template <SurfaceModel Surface, PathLossModel Loss>
double FieldEvaluator<Surface, Loss>::doppler_hz(const Path& path, const std::vector<Vec3>& directions,
                                                 const RadioEnd& transmitter, const RadioEnd& receiver) const {
  double closing_mps =
      glm::dot(transmitter.velocity_mps, directions.front()) - glm::dot(receiver.velocity_mps, directions.back());
  for (std::size_t index = 0; index < path.interactions.size(); ++index) {
    const Interaction& interaction = path.interactions[index];
    const Placement& body = scene_.body_state(scene_.facet(interaction.facet).body).placement;
    const Vec3 velocity_mps = velocity_at(body.velocity, body.pose.position_m, interaction.point_m);
    closing_mps += glm::dot(velocity_mps, directions[index + 1] - directions[index]);
  }
  return closing_mps * (frequency_hz_ / speed_of_light_mps);
}

template <SurfaceModel Surface, PathLossModel Loss>
PathContribution FieldEvaluator<Surface, Loss>::evaluate(Path path, const RadioEnd& transmitter,
                                                         const RadioEnd& receiver) const {
  const std::vector<Vec3> legs = directions(path, transmitter.position_m, receiver.position_m);
  PathContribution contribution;
  contribution.departure = detail::direction_of(legs.front());
  contribution.arrival = detail::direction_of(-legs.back());
  contribution.transfer = medium_.damped(transfer(path, legs, transmitter.position_m, receiver.position_m), path,
                                         contribution.departure, contribution.arrival);
  detail::apply_antennas(contribution, transmitter, legs.front(), receiver, -legs.back());
  contribution.delay_s = path.length_m / speed_of_light_mps;
  contribution.doppler_hz = doppler_hz(path, legs, transmitter, receiver);
  contribution.path = std::move(path);
  return contribution;
}

}  // namespace dcem
