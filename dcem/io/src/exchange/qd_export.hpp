#pragma once
/// Files of NIST's Q-D realization software, as the module qd-channel of ns-3 reads them. Private to dcem::io.
///
/// Format: github.com/wigig-tools/qd-realization (folder Output/Ns3) and github.com/signetlabdei/qd-channel
/// (model/qd-channel-model.cc). A file for each transmitter and receiver, a block for each frame: the number of rays,
/// and, where there are any, seven lines with one number of each ray: delay in s, path gain in dB, phase in rad; zenith
/// and azimuth of departure and of arrival in degrees, azimuth from 0 to 360. The phase is that beside the way: ns-3
/// adds −2π·f·delay to it.
#include <vector>

#include "dcem/geometry/vector.hpp"
#include "dcem/io/src/exchange/frame_export.hpp"
#include "dcem/io/src/exchange/growing_files.hpp"

namespace dcem::io {

/// A device that sends and one that hears with the same id are one node; transmitters are numbered first.
class QdExport : public FrameExport {
 public:
  explicit QdExport(const ExportContext& context);
  void add(const FrameResult& frame, const Frame& instant) override;
  void finish() override;

 private:
  void number_nodes(const ExportContext& context);
  void open_files();
  void add_positions(const Frame& instant);
  void append_block(std::string& text, const LinkResult& link) const;
  std::string settings_text() const;

  struct Node {
    Device device;
    Vec3 first_position_m{0.0}, position_m{0.0};
    bool was_there = false;
    std::size_t file = 0;
  };

  const Scene& scene_;
  double frequency_hz_;
  std::vector<Node> nodes_;
  std::vector<std::size_t> transmitter_node_, receiver_node_;
  GrowingFiles files_;
  AtomicFile& positions_;
  AtomicFile& settings_;
  std::vector<std::size_t> file_of_link_;  // by (transmitter, receiver); of a device to itself `no_file`
  std::vector<double> times_s_;
};

}  // namespace dcem::io
