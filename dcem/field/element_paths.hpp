#pragma once
/// The channel between the elements of two arrays with a path of its own for each pair of elements.
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "dcem/field/array_channel.hpp"
#include "dcem/field/field_evaluator.hpp"
#include "dcem/paths/discover/path_cache.hpp"
#include "dcem/paths/solve/path_solver.hpp"

namespace dcem {

/// The elements of a device, each an end of its own.
struct ElementEnds {
  std::vector<LinkEnd> link;
  std::vector<RadioEnd> radio;
};

/// `centre` is the end of the whole device: its elements ride on the same body and are mounted on the same facets.
template <typename Index>
ElementEnds element_ends(const SceneTracer<Index>& tracer, const LinkEnd& centre, const RadioEnd& device,
                         double wavelength_m, TraversalCounters& counters) {
  ElementEnds ends;
  RadioEnd element = device;
  element.antenna.array = {};
  for (std::size_t index = 0; index < device.antenna.array.size(); ++index) {
    const Vec3 offset_m = device.rotation * element_offset_m(device.antenna.array, index, wavelength_m);
    element.position_m = device.position_m + offset_m;
    LinkEnd end = make_link_end(tracer, element.position_m, centre.ignored_body, counters);
    end.mounted_on.insert(end.mounted_on.end(), centre.mounted_on.begin(), centre.mounted_on.end());
    std::sort(end.mounted_on.begin(), end.mounted_on.end());
    end.mounted_on.erase(std::unique(end.mounted_on.begin(), end.mounted_on.end()), end.mounted_on.end());
    ends.link.push_back(std::move(end));
    ends.radio.push_back(element);
  }
  return ends;
}

/// Solves the path that was found between the centres again for each pair of elements; a pair that has no such path has
/// a zero in the channel. What only a pair of elements sees, and not the centres, is not looked for.
template <typename Index, SurfaceModel Surface, PathLossModel Loss>
class ElementPaths {
 public:
  /// Everything named must outlive it.
  ElementPaths(PathSolver<Index>& solver, const FieldEvaluator<Surface, Loss>& evaluator,
               const ElementEnds& transmitter, const ElementEnds& receiver)
      : solver_(solver), evaluator_(evaluator), transmitter_(transmitter), receiver_(receiver) {}

  /// Rows are element·ports + port of the receiver, columns those of the transmitter.
  ChannelMatrix channel(const Path& path) {
    const Sequence sequence = sequence_of(path);
    const std::size_t receive_ports = receiver_.radio.front().antenna.port_count();
    const std::size_t transmit_ports = transmitter_.radio.front().antenna.port_count();
    ChannelMatrix channel(receiver_.link.size() * receive_ports, transmitter_.link.size() * transmit_ports);
    for (std::size_t to = 0; to < receiver_.link.size(); ++to) {
      for (std::size_t from = 0; from < transmitter_.link.size(); ++from) {
        const ComplexMatrix2 ports = ports_between(from, to, sequence);
        for (std::size_t out = 0; out < receive_ports; ++out) {
          for (std::size_t in = 0; in < transmit_ports; ++in) {
            channel(to * receive_ports + out, from * transmit_ports + in) = ports(out, in);
          }
        }
      }
    }
    return channel;
  }

 private:
  ComplexMatrix2 ports_between(std::size_t from, std::size_t to, const Sequence& sequence) {
    std::optional<Path> path = solver_.solve(transmitter_.link[from], receiver_.link[to], sequence);
    if (!path) return {};
    return evaluator_.evaluate(std::move(*path), transmitter_.radio[from], receiver_.radio[to]).ports;
  }

  PathSolver<Index>& solver_;
  const FieldEvaluator<Surface, Loss>& evaluator_;
  const ElementEnds& transmitter_;
  const ElementEnds& receiver_;
};

}  // namespace dcem
