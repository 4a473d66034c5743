#pragma once
/// The scene of one frame with its rays, scene.glb. Private to dcem::io.
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "dcem/io/src/exchange/frame_export.hpp"
#include "dcem/io/src/exchange/gltf_document.hpp"

namespace dcem::io {

/// Holds the chosen frame, until it comes the first one, so that a run that is ended early has one, too.
class GltfExport : public FrameExport {
 public:
  /// Throws std::invalid_argument where the chosen frame is not among those of the run.
  explicit GltfExport(const ExportContext& context);
  void add(const FrameResult& frame, const Frame& instant) override;
  void finish() override;

 private:
  AtomicFile& file_;
  const Scene& scene_;
  std::span<const Device> receivers_;
  GltfSettings settings_;
  std::size_t chosen_;
  bool diffuse_paths_;
  std::string bytes_;
};

}  // namespace dcem::io
