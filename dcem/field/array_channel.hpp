#pragma once
/// The channel between the elements of two arrays, for one path.
///
/// Here the path is solved once, between the centres, and the elements differ in phase alone (plane waves). Paths that
/// are solved for each pair of elements would fill the same matrix.
#include <cstddef>
#include <vector>

#include "dcem/em/antenna/antenna_array.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/field/path_contribution.hpp"
#include "dcem/field/radio_end.hpp"

namespace dcem {

/// Whether a link has a channel matrix: one of its ends has more than one element.
inline bool has_array(const RadioEnd& transmitter, const RadioEnd& receiver) {
  return !transmitter.antenna.array.is_single() || !receiver.antenna.array.is_single();
}

/// h_ij = ports(p_i, p_j)·exp(+jk·r_i·d_rx)·exp(+jk·r_j·d_tx): the coupling of the ports at the centres, and the phases
/// of the elements' places (element_phasor). The row is element·ports + port of the receiver, the column that of the
/// transmitter. `departure` and `arrival` are unit directions out of the ends, in the world.
///
/// Valid where k·|r|²/2L is small against 1 (see element_phasor; L is the length to the first edge where there is one),
/// and where every element sees the path: a wall that ends between two elements is not noticed, nor is the change of
/// gain and polarization over the array.
ChannelMatrix plane_wave_channel(const ComplexMatrix2& ports, const RadioEnd& transmitter, const Vec3& departure,
                                 const RadioEnd& receiver, const Vec3& arrival);

// ---------------------------------------------------------------------------------------------------------------------

namespace detail {

inline std::vector<Complex> phasors_towards(const RadioEnd& end, const Vec3& direction) {
  return element_phasors(end.antenna.array, direction * end.rotation);  // the transpose times the direction
}

}  // namespace detail

inline ChannelMatrix plane_wave_channel(const ComplexMatrix2& ports, const RadioEnd& transmitter, const Vec3& departure,
                                        const RadioEnd& receiver, const Vec3& arrival) {
  const std::vector<Complex> sent = detail::phasors_towards(transmitter, departure);
  const std::vector<Complex> heard = detail::phasors_towards(receiver, arrival);
  const std::size_t receive_ports = receiver.antenna.port_count(), transmit_ports = transmitter.antenna.port_count();
  ChannelMatrix channel(heard.size() * receive_ports, sent.size() * transmit_ports);
  for (std::size_t row = 0; row < channel.rows(); ++row) {
    for (std::size_t column = 0; column < channel.columns(); ++column) {
      const Complex phase = heard[row / receive_ports] * sent[column / transmit_ports];
      channel(row, column) = ports(row % receive_ports, column % transmit_ports) * phase;
    }
  }
  return channel;
}

}  // namespace dcem
