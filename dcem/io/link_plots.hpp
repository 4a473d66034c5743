#pragma once
/// Pictures of one link over time: its powers and spreads, its power delay profile, the delays of its paths.
///
/// Frames are handed in one after the other; of each only figures are kept. What is drawn depends on the frames alone.
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dcem/channel/power_delay_profile.hpp"
#include "dcem/io/heat_map.hpp"
#include "dcem/io/line_chart.hpp"
#include "dcem/io/scatter_chart.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::io {

/// The link of a transmitter and a receiver, as its pictures name it.
struct LinkNames {
  std::string transmitter, receiver;
  double power_dbm = 0.0;  ///< of the transmitter
};

/// The power delay profile of one instant as bars over delay in ns: specular paths, and where there is any, diffuse
/// power beside it. `bin_s` is the width of the bins of `taps`. Bars end at a multiple of 20 dB, 60 to 80 dB below the
/// highest; weaker taps are left out. Throws std::invalid_argument unless bin_s > 0.
LineChart profile_chart(std::string title, std::span<const PdpTap> taps, double bin_s, double power_dbm);

class LinkPlots {
 public:
  /// `bin_s` and `mode` are those of the power delay profiles. Throws std::invalid_argument unless bin_s > 0.
  LinkPlots(LinkNames names, double bin_s, PdpMode mode);

  /// Appends a frame, later than the last one. A null `link` stands for a frame in which an end is absent. Throws
  /// std::invalid_argument where the bins are too narrow for its delays.
  void add(const Scene& scene, double time_s, const LinkResult* link);

  std::size_t frames() const { return times_s_.size(); }

  /// Charts over time, those that have a value: received power; power by mechanism; rms delay spread; K factor;
  /// Doppler; how many paths are new, gone or kept since the frame before, by their ids.
  std::vector<LineChart> charts() const;

  /// The three that papers print of a drive: received power, rms delay spread and Doppler, for `write_panels`.
  std::vector<LineChart> panels() const;

  /// What titles end with: a word on what the pictures may lack. Empty: nothing.
  void set_note(std::string note) { note_ = std::move(note); }

  /// "mast to car", and the note.
  std::string name() const { return with_note(names_.transmitter + " to " + names_.receiver); }

  /// Power over time and delay. Of more than 1000 frames, neighbours are joined to their mean power; of more than 280
  /// bins, neighbours to their sum; the title says so. Taps more than 70 dB below the
  /// strongest are left out. Nothing where no power arrives in any frame.
  std::optional<HeatMap> profile() const;

  /// Every specular path of every frame over time and delay. Nothing where there is none.
  std::optional<ScatterChart> taps() const;

  /// The power delay profile of one frame, counted from the first that was added; it has no bar where nothing arrives.
  LineChart profile_at(std::size_t frame) const;

 private:
  /// A path in one frame.
  struct Dot {
    std::uint64_t id = 0;  // hash of its name: for colours and lines alone
    double delay_s = 0.0, power_dbm = 0.0;
    bool was_there = false;  // in the frame before
    bool is_direct = false;
  };
  struct PathCounts {
    double kept = 0.0, born = 0.0, gone = 0.0;
  };
  /// What is kept of a frame.
  struct Figures {
    std::optional<LinkStatistics> statistics;  // absent: no link
    std::optional<PathCounts> paths;           // absent: no frame before
    std::vector<PdpTap> taps;
    std::vector<Dot> dots;
  };

  void count_paths(std::vector<std::string>&& ids, Figures& figures);
  template <typename Value>
  LineChart::Series series(const char* name, double scale, Value&& value) const;
  template <typename Visit>
  void each_strong_tap(Visit&& visit) const;
  LineChart power_chart() const;
  LineChart spread_chart() const;
  LineChart doppler_chart() const;
  LineChart mechanism_chart() const;
  LineChart count_chart() const;
  LineChart chart(const char* what, const char* label, const char* unit) const;
  std::string title(const std::string& what) const;
  std::string with_note(const std::string& text) const { return note_.empty() ? text : text + "; " + note_; }

  LinkNames names_;
  std::string note_;
  double bin_s_;
  PdpMode mode_;
  std::vector<double> times_s_;
  std::vector<Figures> figures_;
  std::vector<std::string> ids_;  // of the last frame, sorted
};

}  // namespace dcem::io
