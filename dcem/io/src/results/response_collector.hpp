#pragma once
/// The channel frequency responses of a run, for `cfr.npz`. Private to dcem::io.
#include <complex>
#include <span>
#include <string>
#include <vector>

#include "dcem/channel/frequency_response.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/result_writer.hpp"

namespace dcem::io {

/// Arrays, frames first: `h` complex128 [F,R,T,N] (with a dual-polarized antenna among the devices [F,R,T,2,2,N],
/// receive port before transmit port), `valid` bool [F,R,T], `frequency_hz` [N], `time_s` [F], `tx_id`, `rx_id`.
class ResponseCollector {
 public:
  /// Throws std::invalid_argument where the arrays would need more than 16 GB.
  ResponseCollector(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers,
                    const ResultFacts& facts, const OutputSettings& output);

  void add(const FrameResult& frame);
  void write();

 private:
  std::size_t row_of(const LinkResult& link) const;
  std::vector<std::complex<double>> response_of(const LinkResult& link) const;

  AtomicFile& file_;
  FrequencyGrid grid_;
  std::vector<std::string> transmitters_, receivers_;
  bool has_ports_ = false;
  std::vector<double> times_s_;
  std::vector<std::complex<double>> responses_;
  std::vector<bool> valid_;
};

}  // namespace dcem::io
