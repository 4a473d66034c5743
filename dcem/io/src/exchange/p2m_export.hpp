#pragma once
/// Paths as Wireless InSite lists them, p2m/…/dcem.paths.t001_01.r002.p2m. Private to dcem::io.
///
/// Format: Remcom, "Wireless InSite Reference Manual", output files, as the public parser of DeepMIMO reads it
/// (github.com/DeepMIMO/DeepMIMO, converters/wireless_insite/p2m_parser.py): 21 lines of comment; the number of
/// receivers; for each its number and that of its paths; where there are any, power in dBm, mean delay and delay spread
/// in s; for each path number, interactions, power in dBm, phase in degrees, delay in s, zenith and azimuth of arrival
/// and of departure in degrees, then what it does ("Tx-R-D-Rx"), then its points.
#include <string>
#include <vector>

#include "dcem/io/src/exchange/frame_export.hpp"

namespace dcem::io {

/// A file for each frame and transmitter, written as the frame comes. Transmitters are of set 1, receivers of set 2.
class P2mExport : public FrameExport {
 public:
  explicit P2mExport(const ExportContext& context);
  void add(const FrameResult& frame, const Frame& instant) override;
  void finish() override {}

 private:
  std::string name_of(std::size_t frame, std::size_t transmitter) const;
  void append_receiver(std::string& text, std::size_t receiver, const LinkResult* link, const Frame& instant) const;

  OutputFolder& folder_;
  const Scene& scene_;
  std::span<const Device> receivers_;
  bool has_frames_;
  bool diffuse_paths_;
};

}  // namespace dcem::io
