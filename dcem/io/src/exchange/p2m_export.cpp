#include "dcem/io/src/exchange/p2m_export.hpp"

#include <algorithm>
#include <array>
#include <complex>
#include <cstdio>
#include <stdexcept>

#include "dcem/core/units.hpp"
#include "dcem/io/src/results/link_entries.hpp"
#include "dcem/io/src/text/number_text.hpp"

namespace dcem::io {
namespace {

constexpr std::size_t most_p2m_files = 100'000;
constexpr std::size_t comment_lines = 21;

/// Numbers of one line.
class P2mLine {
 public:
  explicit P2mLine(std::string& text) : text_(text) {}

  template <typename Number>
  P2mLine& number(Number value) {
    if (!is_first_) text_ += ' ';
    is_first_ = false;
    append_number(text_, value);
    return *this;
  }
  P2mLine& point(const Vec3& point_m) { return number(point_m.x).number(point_m.y).number(point_m.z); }
  void end() { text_ += '\n'; }

 private:
  std::string& text_;
  bool is_first_ = true;
};

const char* letters_of(InteractionKind kind) {
  switch (kind) {
    case InteractionKind::reflection:
      return "-R";
    case InteractionKind::scattering:
      return "-DS";
    case InteractionKind::transmission:
      return "-T";
    case InteractionKind::diffraction:
      break;
  }
  return "-D";
}

std::string p2m_head() {
  std::string text =
      "# Paths of DCEM in the form of Wireless InSite\n"
      "# <number of receivers>\n"
      "# <receiver> <number of paths>\n"
      "# <received power, dBm> <mean time of arrival, s> <delay spread, s>\n"
      "# <path> <interactions> <power, dBm> <phase, deg> <time of arrival, s> <arrival theta, deg> <arrival phi, deg> "
      "<departure theta, deg> <departure phi, deg>\n"
      "# <what the path does>\n"
      "# <x, m> <y, m> <z, m>, from the transmitter to the receiver\n";
  const auto written = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
  for (std::size_t line = written; line < comment_lines; ++line) text += "#\n";
  return text;
}

void append_p2m_path(std::string& text, std::size_t number, const LinkEntry& entry, double power_dbm,
                     const Vec3& from_m, const Vec3& to_m) {
  const PowerSample sample = entry.path != nullptr ? power_sample(*entry.path) : entry.tile->sample;
  const std::vector<Interaction>& interactions = entry.geometry().interactions;
  // What has no phase, a tile of a rough surface, has phase 0.
  const double phase_rad = entry.path != nullptr ? std::arg(entry.path->amplitude) : 0.0;
  P2mLine line(text);
  line.number(number).number(interactions.size()).number(power_dbm + power_ratio_to_db(sample.power_ratio));
  line.number(radians_to_degrees(phase_rad)).number(sample.delay_s);
  for (const Direction& direction : {sample.arrival, sample.departure}) {
    line.number(radians_to_degrees(direction.zenith_rad)).number(radians_to_degrees(direction.azimuth_rad));
  }
  line.end();
  text += "Tx";
  for (const Interaction& at : interactions) text += letters_of(at.kind);
  text += "-Rx\n";
  P2mLine(text).point(from_m).end();
  for (const Interaction& at : interactions) P2mLine(text).point(at.point_m).end();
  P2mLine(text).point(to_m).end();
}

}  // namespace

P2mExport::P2mExport(const ExportContext& context)
    : folder_(context.folder),
      scene_(context.scene),
      receivers_(context.receivers),
      has_frames_(context.facts.frames > 1),
      diffuse_paths_(context.facts.diffuse_paths) {
  require_single_ports(context, "output.p2m: a path has one phase in p2m files");
  const std::size_t files = context.facts.frames * scene_.transmitters().size();
  if (files <= most_p2m_files) return;
  throw std::invalid_argument("output.p2m: frames and transmitters need " + std::to_string(files) +
                              " files; expected at most " + std::to_string(most_p2m_files) + " (fewer frames)");
}

/// "p2m/frame_0012/dcem.paths.t003_01.r002.p2m"; without the frame where there is one alone.
std::string P2mExport::name_of(std::size_t frame, std::size_t transmitter) const {
  std::array<char, 64> name{};
  std::snprintf(name.data(), name.size(), "dcem.paths.t%03zu_01.r002.p2m", transmitter + 1);
  if (!has_frames_) return std::string("p2m/") + name.data();
  std::array<char, 64> folder{};
  std::snprintf(folder.data(), folder.size(), "p2m/frame_%04zu/", frame);
  return std::string(folder.data()) + name.data();
}

void P2mExport::add(const FrameResult& frame, const Frame& instant) {
  const std::size_t receivers = receivers_.size(), transmitters = scene_.transmitters().size();
  const auto links = links_by_ends(frame, transmitters, receivers);
  for (std::size_t tx = 0; tx < transmitters; ++tx) {
    AtomicFile& file = folder_.open(name_of(frame.index, tx));
    std::string text = p2m_head() + std::to_string(receivers) + "\n";
    for (std::size_t rx = 0; rx < receivers; ++rx) append_receiver(text, rx, links[tx * receivers + rx], instant);
    file.write(text);
    file.close();
  }
}

/// Without paths whose power is no number, because an antenna does not hear them at all.
void P2mExport::append_receiver(std::string& text, std::size_t receiver, const LinkResult* link,
                                const Frame& instant) const {
  std::vector<LinkEntry> entries;
  if (link != nullptr) entries = link_entries(*link, diffuse_paths_);
  std::erase_if(entries, [](const LinkEntry& entry) { return !(entry.power_ratio() > 0.0); });
  P2mLine(text).number(receiver + 1).number(entries.size()).end();
  if (entries.empty()) return;
  const Device& tx = scene_.transmitters()[link->transmitter];
  const LinkStatistics& values = link->statistics;
  P2mLine(text)
      .number(values.power_dbm.value_or(0.0))
      .number(values.mean_delay_s.value_or(0.0))
      .number(values.rms_delay_spread_s.value_or(0.0))
      .end();
  const Vec3 from_m = scene_.device_state(tx, instant).position_m;
  const Vec3 to_m = scene_.device_state(receivers_[receiver], instant).position_m;
  for (std::size_t path = 0; path < entries.size(); ++path) {
    append_p2m_path(text, path + 1, entries[path], tx.power_dbm, from_m, to_m);
  }
}

}  // namespace dcem::io
