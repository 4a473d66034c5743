#include "dcem/io/result_writer.hpp"
#include <utility>

#include "dcem/core/beside.hpp"
#include "dcem/core/naming.hpp"
#include "dcem/core/thread_pool.hpp"

#include "dcem/channel/doppler_spectrum.hpp"
#include "dcem/core/units.hpp"
#include "dcem/io/src/exchange/frame_export.hpp"
#include "dcem/io/src/pictures/plot_collector.hpp"
#include "dcem/io/src/results/link_pieces.hpp"
#include "dcem/io/src/results/path_collector.hpp"
#include "dcem/io/src/results/path_lines.hpp"
#include "dcem/io/src/results/response_collector.hpp"
#include "dcem/io/src/text/gzip_encoder.hpp"
#include "dcem/io/src/text/number_text.hpp"

namespace dcem::io {
namespace {

AtomicFile* open_sheet(OutputFolder& folder, bool wanted, const char* name) {
  return wanted ? &folder.open(name) : nullptr;
}

}  // namespace

bool needs_paths(const OutputSettings& output) {
  return output.paths || output.pdp || output.doppler || output.cfr || output.npz || output.exchange.mat ||
         output.plots || output.html || wants_exports(output);
}

ResultWriter::Sheet::Sheet() = default;

ResultWriter::Sheet::~Sheet() = default;

void ResultWriter::Sheet::write(std::string_view text) {
  if (file == nullptr || text.empty()) return;
  gzip != nullptr ? gzip->write(text) : file->write(text);
}

ResultWriter::ResultWriter(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers,
                           const ResultFacts& facts, const OutputSettings& output)
    : output_(output),
      facts_(facts),
      scene_(scene),
      link_lines_(scene, receivers),
      alone_(std::make_unique<ThreadPool>(1)),
      lines_(std::make_unique<PathLines>(scene, receivers, facts, output.paths_top)),
      writing_(std::make_unique<Beside>(pool().size() > 1)) {
  paths_.file = open_sheet(folder, output.paths, output.paths_gzip ? "paths.jsonl.gz" : "paths.jsonl");
  if (output.paths && output.paths_gzip) paths_.gzip = std::make_unique<GzipEncoder>(*paths_.file);
  links_.file = open_sheet(folder, output.links, "links.csv");
  profile_.file = open_sheet(folder, output.pdp, "pdp.csv");
  doppler_.file = open_sheet(folder, output.doppler, "doppler.csv");
  links_.write(std::string(links_csv_header) + '\n');
  profile_.write(std::string(facts.diffuse ? diffuse_pdp_csv_header : pdp_csv_header) + '\n');
  doppler_.write(std::string(doppler_csv_header) + '\n');
  if (output.cfr) responses_ = std::make_unique<ResponseCollector>(folder, scene, receivers, facts, output);
  if (output.npz || output.exchange.mat)
    arrays_ = std::make_unique<PathCollector>(folder, scene, receivers, facts, output);
  if (output.plots) plots_ = std::make_unique<PlotCollector>(folder, scene, receivers, facts, output);
  exports_ = make_exports({folder, scene, receivers, facts, output});
  for (const Device& device : scene.transmitters()) power_dbm_.push_back(device.power_dbm);
}

ResultWriter::~ResultWriter() = default;

ResultWriter::Lines ResultWriter::lines_of(const FrameResult& frame, std::span<const LinkResult> links) const {
  Lines lines;
  for (const LinkResult& link : links) {
    if (output_.paths) lines_->append(lines.paths, frame, link);
    if (output_.links) link_lines_.append(lines.links, frame, link);
    if (output_.pdp) dcem::detail::naming("output.pdp.bin_s", [&] { append_profile(lines.profile, frame, link); });
    if (output_.doppler)
      dcem::detail::naming("output.doppler.bin_hz", [&] { append_doppler(lines.doppler, frame, link); });
  }
  return lines;
}

void ResultWriter::write(const FrameResult& frame) {
  const auto make = [&](std::span<const LinkResult> links) { return lines_of(frame, links); };
  in_pieces<Lines>(pool(), frame.links, make, [this](std::vector<Lines>&& pieces) {
    writing_->start([this, pieces = std::move(pieces)] {
      for (const Lines& lines : pieces) {
        paths_.write(lines.paths);
        links_.write(lines.links);
        profile_.write(lines.profile);
        doppler_.write(lines.doppler);
      }
    });
  });
  if (responses_) responses_->add(frame);
  if (arrays_) arrays_->add(frame);
  if (plots_) plots_->add(frame);
  if (exports_.empty()) return;
  const Frame instant = frame_now(scene_, frame);
  for (const auto& file : exports_) file->add(frame, instant);
}

LinePieces ResultWriter::link_lines(const FrameResult& frame) {
  return output_.links ? link_lines_.pieces(frame, pool()) : std::make_shared<std::vector<std::string>>();
}

void ResultWriter::write_lines(LinePieces lines) {
  writing_->start([this, lines = std::move(lines)] {
    for (const std::string& text : *lines) links_.write(text);
  });
}

void ResultWriter::write_lines(std::string_view lines) {
  writing_->wait();
  links_.write(lines);
}

const AtomicFile& ResultWriter::links_so_far() {
  writing_->wait();
  links_.file->rest();
  return *links_.file;
}

void ResultWriter::finish(const std::string& note) {
  writing_->wait();
  if (paths_.gzip != nullptr) paths_.gzip->finish();
  if (responses_) responses_->write();
  if (arrays_) arrays_->write();
  if (plots_) plots_->write(note);
  for (const auto& file : exports_) file->finish();
}

CsvLine ResultWriter::begin_line(std::string& text, const FrameResult& frame, const LinkResult& link) const {
  CsvLine line(text);
  line.count(frame.index).prepared(link_lines_.transmitter(link)).prepared(link_lines_.receiver(link));
  return line;
}

void ResultWriter::append_profile(std::string& text, const FrameResult& frame, const LinkResult& link) const {
  const std::vector<PowerSample> diffuse = power_samples(link.diffuse);
  const double power_dbm = power_dbm_[link.transmitter];
  for (const PdpTap& tap : power_delay_profile(link.paths, diffuse, output_.pdp_bin_s, output_.pdp_mode)) {
    if (!(tap.power_ratio > 0.0)) continue;
    CsvLine line = begin_line(text, frame, link);
    line.number(tap.delay_s).number(power_dbm + power_ratio_to_db(tap.power_ratio));
    if (facts_.diffuse) line.number(dcem::detail::ratio_to_dbm(tap.diffuse_power_ratio, power_dbm));
    line.end();
  }
}

void ResultWriter::append_doppler(std::string& text, const FrameResult& frame, const LinkResult& link) const {
  const std::vector<PowerSample> samples = power_samples(link.paths, link.diffuse);
  for (const DopplerBin& bin : doppler_spectrum(samples, output_.doppler_bin_hz)) {
    CsvLine line = begin_line(text, frame, link);
    line.number(bin.doppler_hz).number(power_dbm_[link.transmitter] + power_ratio_to_db(bin.power_ratio)).end();
  }
}

}  // namespace dcem::io
