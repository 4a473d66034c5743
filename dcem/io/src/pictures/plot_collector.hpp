#pragma once
/// The pictures of the first links of a run, for `output.plots`. Private to dcem::io.
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/link_plots.hpp"
#include "dcem/io/picture_format.hpp"
#include "dcem/io/result_writer.hpp"

namespace dcem::io {

/// Writes `plot_<tx>_<rx>.svg`, `panels_<tx>_<rx>.pdf`, `pdp_<tx>_<rx>.png`, `taps_<tx>_<rx>.png` over time, and
/// `pdp_<tx>_<rx>_<frame>.svg`; all of them in the formats that are asked for, where some are.
class PlotCollector {
 public:
  /// Throws std::invalid_argument where the frame asked for is not among those of the run, and where two links would
  /// have the same file names. The scene must outlive it.
  PlotCollector(OutputFolder& folder, const Scene& scene, std::span<const Device> receivers, const ResultFacts& facts,
                const OutputSettings& output);

  /// Throws std::invalid_argument where the bins of `output.pdp` are too narrow.
  void add(const FrameResult& frame);
  /// `note`: as `LinkPlots::set_note` has it.
  void write(const std::string& note);

 private:
  struct Link {
    std::size_t transmitter = 0, receiver = 0;
    std::string name;  // "<tx>_<rx>", as it stands in file names
    LinkPlots plots;
  };

  Link link(std::size_t transmitter, std::size_t receiver) const;
  void add_new_links(const FrameResult& frame);
  void check_names() const;
  void write_over_time(const Link& link);
  template <typename Draw>
  void write_files(const std::string& name, PictureFormat usual, Draw&& draw);

  OutputFolder& folder_;
  const Scene& scene_;
  std::span<const Device> receivers_;
  double pdp_bin_s_ = 0.0;
  PdpMode pdp_mode_;
  std::optional<std::size_t> profile_frame_;  // counted from the first of the run; absent: the middle one
  std::size_t first_frame_ = 0;
  PictureFormats formats_;
  std::vector<Link> links_;      // by transmitter, then receiver
  std::size_t room_ = 0;         // so many links that have not been there yet will have pictures, too …
  std::vector<double> times_s_;  // … with a gap where these instants are
};

}  // namespace dcem::io
