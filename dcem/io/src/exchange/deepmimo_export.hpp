#pragma once
/// A scenario of DeepMIMO, version 4, folder deepmimo. Private to dcem::io.
///
/// Format: github.com/DeepMIMO/DeepMIMO, as of version 4.0.5 (datasets/load.py, core/scene.py): params.json; for each
/// transmitter eleven arrays over receivers, paths and interactions, missing places NaN; the scene as a mesh. A run of
/// several frames has a folder scene_0000, scene_0001, … for each. Angles are in degrees, zeniths counted from +z,
/// power is path gain in dB, which DeepMIMO takes for dBW of one watt sent.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "dcem/io/npz_writer.hpp"
#include "dcem/io/src/exchange/frame_export.hpp"

namespace dcem::io {

/// Paths stand strongest first: DeepMIMO reads the first 25 unless asked for more.
class DeepMimoExport : public FrameExport {
 public:
  explicit DeepMimoExport(const ExportContext& context);
  void add(const FrameResult& frame, const Frame& instant) override;
  void finish() override;

 private:
  using Paths = std::vector<const PathContribution*>;

  std::string folder_of(std::size_t number) const;
  std::vector<Paths> paths_of(const FrameResult& frame, std::size_t transmitter);
  void write_transmitter(const std::string& folder, std::size_t transmitter, const std::vector<Paths>& paths,
                         const Frame& instant);
  void write_fields(const std::string& end, const std::vector<Paths>& paths, std::size_t longest);
  void write_interactions(const std::string& end, const std::vector<Paths>& paths, std::size_t longest);
  void write_places(const std::string& end, std::size_t transmitter, const Frame& instant);
  void write_scene(const std::string& folder, const Frame& instant);
  void write_array(const std::string& name, const std::string& key, const NpzWriter::Shape& shape,
                   const std::vector<double>& values);
  void count(const PathContribution& path);
  std::string parameters() const;

  OutputFolder& folder_;
  const Scene& scene_;
  std::span<const Device> receivers_;
  double frequency_hz_;
  bool has_frames_;
  AtomicFile& parameters_;
  std::size_t frames_ = 0, objects_ = 0, vertices_ = 0, triangles_ = 0;
  std::array<std::size_t, 5> most_of_kind_{};  // by DeepMIMO's code of an interaction; 0: of all together
};

}  // namespace dcem::io
