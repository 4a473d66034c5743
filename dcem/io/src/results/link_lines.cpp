#include "dcem/io/link_lines.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "dcem/channel/coherence.hpp"
#include "dcem/core/thread_pool.hpp"
#include "dcem/io/src/results/link_pieces.hpp"
#include "dcem/io/src/text/number_text.hpp"

namespace dcem::io {
namespace {

/// What all lines of a frame begin with.
std::string beginning(const FrameResult& frame) {
  std::string fields;
  CsvLine(fields).count(frame.index).number(frame.time_s);
  return fields;
}

}  // namespace

LinkLines::LinkLines(const Scene& scene, std::span<const Device> receivers) {
  for (const Device& device : scene.transmitters()) transmitters_.push_back(csv_field(device.id));
  for (const Device& device : receivers) receivers_.push_back(csv_field(device.id));
}

LinePieces LinkLines::pieces(const FrameResult& frame, ThreadPool& pool) const {
  const std::string begun = beginning(frame);
  const std::vector<std::span<const LinkResult>> pieces = link_pieces(frame.links);
  auto lines = std::make_shared<std::vector<std::string>>(pieces.size());
  pool.for_each(pieces.size(), [&](std::size_t piece, unsigned) {
    std::string text;  // moved when it is whole: what several threads write to should not lie side by side
    for_each_link(pieces[piece], [&](const LinkResult& link) { append(text, begun, link); });
    (*lines)[piece] = std::move(text);
  });
  return lines;
}

void LinkLines::append(std::string& text, const FrameResult& frame, const LinkResult& link) const {
  append(text, beginning(frame), link);
}

void LinkLines::append(std::string& text, std::string_view begun, const LinkResult& link) const {
  const LinkStatistics& values = link.statistics;
  const std::vector<PowerSample> samples = power_samples(link.paths, link.diffuse);
  CsvLine line(text, begun);
  line.prepared(transmitter(link)).prepared(receiver(link));
  line.flag(values.line_of_sight).count(values.path_count).flag(link.complete);
  line.number(link.valid_until_m);
  line.number(values.power_dbm).number(values.power_incoherent_dbm).number(values.power_los_dbm);
  line.number(values.power_reflected_dbm).number(values.power_transmitted_dbm);
  line.number(values.power_diffracted_dbm).number(values.power_diffuse_dbm);
  line.number(values.path_gain_db).number(values.first_delay_s).number(values.mean_delay_s);
  line.number(values.rms_delay_spread_s).number(values.k_factor_db);
  line.number(values.azimuth_spread_arrival_rad).number(values.azimuth_spread_departure_rad);
  line.number(values.mean_doppler_hz).number(values.rms_doppler_spread_hz);
  line.number(values.zenith_spread_arrival_rad).number(values.zenith_spread_departure_rad);
  line.number(coherence_bandwidth_hz(samples)).number(coherence_time_s(samples)).end();
}

}  // namespace dcem::io
