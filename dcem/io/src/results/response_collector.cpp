#include "dcem/io/src/results/response_collector.hpp"

#include <algorithm>

#include "dcem/io/npz_writer.hpp"
#include "dcem/io/src/results/array_parts.hpp"

namespace dcem::io {
namespace {

bool any_is_dual(std::span<const Device> devices) {
  return std::any_of(devices.begin(), devices.end(), [](const Device& device) { return device.antenna.is_dual(); });
}

}  // namespace

ResponseCollector::ResponseCollector(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers,
                                     const ResultFacts& facts, const OutputSettings& output)
    : file_(folder.open("cfr.npz")),
      grid_{facts.frequency_hz, output.cfr_bandwidth_hz, output.cfr_points},
      transmitters_(ids_of(scene.transmitters())),
      receivers_(ids_of(receivers)),
      has_ports_(any_is_dual(scene.transmitters()) || any_is_dual(receivers)) {
  const double values = static_cast<double>(facts.frames) * static_cast<double>(receivers_.size()) *
                        static_cast<double>(transmitters_.size()) * static_cast<double>(grid_.points) *
                        (has_ports_ ? 4.0 : 1.0);
  const double bytes = values * static_cast<double>(sizeof(std::complex<double>));
  require_array_memory("output.cfr: the responses of this run", bytes, "", facts.memory_limit_bytes,
                       "fewer frames, receivers or points");
}

std::size_t ResponseCollector::row_of(const LinkResult& link) const {
  return link.receiver * transmitters_.size() + link.transmitter;
}

std::vector<std::complex<double>> ResponseCollector::response_of(const LinkResult& link) const {
  if (!has_ports_) return frequency_response(link.paths, grid_);
  const std::vector<ComplexMatrix2> matrices = port_frequency_response(link.paths, grid_);
  std::vector<std::complex<double>> response;
  for (std::size_t port = 0; port < 4; ++port) {
    for (const ComplexMatrix2& matrix : matrices) response.push_back(matrix(port / 2, port % 2));
  }
  return response;
}

void ResponseCollector::add(const FrameResult& frame) {
  const std::size_t rows = receivers_.size() * transmitters_.size();
  const std::size_t values = grid_.points * (has_ports_ ? 4 : 1);
  const std::size_t first_row = times_s_.size() * rows;
  times_s_.push_back(frame.time_s);
  responses_.resize(responses_.size() + rows * values);
  valid_.resize(valid_.size() + rows, false);
  for (const LinkResult& link : frame.links) {
    const std::vector<std::complex<double>> response = response_of(link);
    const std::size_t row = first_row + row_of(link);
    std::copy(response.begin(), response.end(), responses_.begin() + static_cast<std::ptrdiff_t>(row * values));
    valid_[row] = true;
  }
}

void ResponseCollector::write() {
  std::vector<double> frequencies_hz;
  for (std::size_t k = 0; k < grid_.points; ++k) frequencies_hz.push_back(grid_.frequency_hz(k));
  const NpzWriter::Shape links{times_s_.size(), receivers_.size(), transmitters_.size()};
  NpzWriter::Shape shape = links;
  if (has_ports_) shape.insert(shape.end(), {2, 2});
  shape.push_back(grid_.points);
  NpzWriter npz;
  npz.add("h", shape, std::span<const std::complex<double>>(responses_));
  npz.add("valid", links, valid_);
  npz.add("frequency_hz", {grid_.points}, std::span<const double>(frequencies_hz));
  npz.add("time_s", {times_s_.size()}, std::span<const double>(times_s_));
  npz.add("tx_id", {transmitters_.size()}, std::span<const std::string>(transmitters_));
  npz.add("rx_id", {receivers_.size()}, std::span<const std::string>(receivers_));
  npz.write(file_);
}

}  // namespace dcem::io
