#include "dcem/io/src/pictures/plot_collector.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>

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

/// Where there are all links: those with numbers below `most` of all that have pictures when there is no end of them.
template <typename Visit>
void each_link(std::span<const Device> transmitters, std::span<const Device> receivers, std::size_t most,
               Visit&& visit) {
  for (std::size_t transmitter = 0; transmitter < transmitters.size(); ++transmitter) {
    for (std::size_t receiver = 0; receiver < receivers.size(); ++receiver) {
      if (transmitters[transmitter].id == receivers[receiver].id) continue;
      if (most-- == 0) return;
      visit(transmitter, receiver);
    }
  }
}

std::pair<std::size_t, std::size_t> ends_of(const LinkResult& link) {
  return {link.transmitter, link.receiver};
}

}  // namespace

std::size_t plotted_links(const Scene& scene, std::span<const Device> receivers) {
  std::size_t links = 0;
  each_link(scene.transmitters(), receivers, std::numeric_limits<std::size_t>::max(),
            [&](std::size_t, std::size_t) { ++links; });
  return links;
}

PlotCollector::PlotCollector(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers,
                             const ResultFacts& facts, const OutputSettings& output)
    : folder_(folder),
      scene_(scene),
      receivers_(receivers),
      pdp_bin_s_(output.pdp_bin_s),
      pdp_mode_(output.pdp_mode),
      profile_frame_(profile_frame_of(facts, output)),
      first_frame_(facts.first_frame),
      formats_(output.plots_formats) {
  if (facts.all_links) {
    each_link(scene.transmitters(), receivers, output.plots_max_links,
              [&](std::size_t transmitter, std::size_t receiver) { links_.push_back(link(transmitter, receiver)); });
  } else {
    room_ = output.plots_max_links;
  }
  check_names();
}

PlotCollector::Link PlotCollector::link(std::size_t transmitter, std::size_t receiver) const {
  const Device &from = scene_.transmitters()[transmitter], &to = receivers_[receiver];
  return {transmitter, receiver, file_name_part(from.id) + "_" + file_name_part(to.id),
          LinkPlots({from.id, to.id, from.power_dbm}, pdp_bin_s_, pdp_mode_)};
}

// Of a choice of links the first ones that there are, as if they had been expected from the first frame on.
void PlotCollector::add_new_links(const FrameResult& frame) {
  for (const LinkResult& result : frame.links) {
    if (room_ == 0) return;
    const auto place = std::lower_bound(links_.begin(), links_.end(), ends_of(result), [](const Link& one, auto ends) {
      return std::pair(one.transmitter, one.receiver) < ends;
    });
    if (place != links_.end() && std::pair(place->transmitter, place->receiver) == ends_of(result)) continue;
    const auto added = links_.insert(place, link(result.transmitter, result.receiver));
    for (const double time_s : times_s_) added->plots.add(scene_, time_s, nullptr);
    --room_;
    check_names();
  }
  times_s_.push_back(frame.time_s);
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
  add_new_links(frame);
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

void PlotCollector::write(const std::string& note) {
  for (Link& link : links_) {
    link.plots.set_note(note);
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
