#pragma once
/// What the files for other programs have in common: each takes one frame after the other. Private to dcem::io.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dcem/io/atomic_file.hpp"
#include "dcem/io/result_writer.hpp"

namespace dcem::io {

/// What the writers of such files are made from.
struct ExportContext {
  OutputFolder& folder;
  const Scene& scene;  ///< outlives the writer, and stands at the frame that is added
  std::span<const Device> receivers;
  const ResultFacts& facts;
  const OutputSettings& output;
};

class FrameExport {
 public:
  FrameExport() = default;
  FrameExport(const FrameExport&) = delete;
  FrameExport& operator=(const FrameExport&) = delete;
  virtual ~FrameExport() = default;

  /// Appends a frame; `instant` says where everything is. Throws `OutputError`, and std::invalid_argument where the
  /// format cannot hold it.
  virtual void add(const FrameResult& frame, const Frame& instant) = 0;
  /// After the last frame, whichever that is.
  virtual void finish() = 0;
};

/// Of each format that is asked for. Throws std::invalid_argument where one cannot hold what the run will bring.
std::vector<std::unique_ptr<FrameExport>> make_exports(const ExportContext& context);

/// Whether any of them is asked for.
bool wants_exports(const OutputSettings& output);

/// Where everything in the scene is now.
Frame frame_now(const Scene& scene, const FrameResult& result);

/// The links of a frame by (transmitter, receiver); null where there is none.
std::vector<const LinkResult*> links_by_ends(const FrameResult& frame, std::size_t transmitters, std::size_t receivers);

/// Throws std::invalid_argument where a device is dual-polarized: its paths have a matrix instead of an amplitude.
/// `what` as in "output.qd: a ray there has one amplitude".
void require_single_ports(const ExportContext& context, const std::string& what);

}  // namespace dcem::io
