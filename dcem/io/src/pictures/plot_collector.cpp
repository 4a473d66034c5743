#include "dcem/io/src/pictures/plot_collector.hpp"

#include <algorithm>
#include <set>
#include <stdexcept>

#include "dcem/io/src/text/file_name.hpp"

namespace dcem::io {
namespace {

std::optional<std::size_t> profile_frame_of(const ResultFacts& facts, const OutputSettings& output) {
  if (!output.plots_pdp_frame) return std::nullopt;
  const std::size_t frame = *output.plots_pdp_frame;
  if (frame >= facts.first_frame && frame - facts.first_frame < facts.frames) return frame - facts.first_frame;
  throw std::invalid_argument("output.plots.pdp_frame: frame " + std::to_string(frame) +
                              " is not among those of this run; expected " + std::to_string(facts.first_frame) +
                              " to " + std::to_string(facts.first_frame + facts.frames - 1));
}

/// Every link that has pictures when there is no end of them, in their order.
template <typename Visit>
void each_link(std::span<const Device> transmitters, std::span<const Device> receivers, Visit&& visit) {
  for (std::size_t transmitter = 0; transmitter < transmitters.size(); ++transmitter) {
    for (std::size_t receiver = 0; receiver < receivers.size(); ++receiver) {
      if (transmitters[transmitter].id != receivers[receiver].id) visit(transmitter, receiver);
    }
  }
}

}  // namespace

std::size_t plotted_links(const Scene& scene, std::span<const Device> receivers) {
  std::size_t links = 0;
  each_link(scene.transmitters(), receivers, [&](std::size_t, std::size_t) { ++links; });
  return links;
}

PlotCollector::PlotCollector(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers,
                             const ResultFacts& facts, const OutputSettings& output)
    : folder_(folder),
      scene_(scene),
      profile_frame_(profile_frame_of(facts, output)),
      first_frame_(facts.first_frame),
      formats_(output.plots_formats) {
  const std::span<const Device> transmitters = scene.transmitters();
  each_link(transmitters, receivers, [&](std::size_t transmitter, std::size_t receiver) {
    if (links_.size() == output.plots_max_links) return;
    const Device &from = transmitters[transmitter], &to = receivers[receiver];
    links_.push_back({transmitter, receiver, file_name_part(from.id) + "_" + file_name_part(to.id),
                      LinkPlots({from.id, to.id, from.power_dbm}, output.pdp_bin_s, output.pdp_mode)});
  });
  check_names();
}

// Two links may differ in a way that their file names do not, as in "a" to "b_c" and "a_b" to "c".
void PlotCollector::check_names() const {
  std::set<std::string> names;
  for (const Link& link : links_) {
    if (names.insert(link.name).second) continue;
    throw std::invalid_argument("output.plots: two links give the file name 'plot_" + link.name +
                                ".svg'; expected ids that keep the names apart");
  }
}

void PlotCollector::add(const FrameResult& frame) {
  // Both lists are by transmitter, then receiver.
  auto result = frame.links.begin();
  for (Link& link : links_) {
    const auto before = [&](const LinkResult& one) {
      return one.transmitter < link.transmitter ||
             (one.transmitter == link.transmitter && one.receiver < link.receiver);
    };
    while (result != frame.links.end() && before(*result)) ++result;
    const bool is_there =
        result != frame.links.end() && result->transmitter == link.transmitter && result->receiver == link.receiver;
    link.plots.add(scene_, frame.time_s, is_there ? &*result : nullptr);
  }
}

template <typename Draw>
void PlotCollector::write_files(const std::string& name, PictureFormat usual, Draw&& draw) {
  for (const PictureFormat format : formats_or(formats_, usual)) {
    AtomicFile& file = folder_.open(name + "." + std::string(word_of(format)));
    draw(file, format);
    file.close();
  }
}

void PlotCollector::write_over_time(const Link& link) {
  const LinkPlots& plots = link.plots;
  write_files("plot_" + link.name, PictureFormat::svg,
              [&](AtomicFile& file, PictureFormat format) { write_line_charts(plots.charts(), file, format); });
  write_files("panels_" + link.name, PictureFormat::pdf, [&](AtomicFile& file, PictureFormat format) {
    write_panels(plots.name(), plots.panels(), file, format);
  });
  if (const auto profile = plots.profile()) {
    write_files("pdp_" + link.name, PictureFormat::png,
                [&](AtomicFile& file, PictureFormat format) { write_heat_map(*profile, file, format); });
  }
  if (const auto taps = plots.taps()) {
    write_files("taps_" + link.name, PictureFormat::png,
                [&](AtomicFile& file, PictureFormat format) { write_scatter_chart(*taps, file, format); });
  }
}

void PlotCollector::write() {
  for (const Link& link : links_) {
    if (link.plots.frames() > 1) write_over_time(link);
    // Of the frames that there are: a run may have been ended before its last.
    const std::size_t frame = profile_frame_.value_or(link.plots.frames() / 2);
    if (frame >= link.plots.frames()) continue;
    const std::string number = std::to_string(first_frame_ + frame);
    const LineChart profile = link.plots.profile_at(frame);
    write_files("pdp_" + link.name + "_" + number, PictureFormat::svg, [&](AtomicFile& file, PictureFormat format) {
      write_line_charts(std::span(&profile, 1), file, format);
    });
  }
}

}  // namespace dcem::io
