#pragma once
/// The lines of `paths.jsonl`. Private to dcem::io.
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dcem/io/result_writer.hpp"

namespace dcem::io {

/// The id of a listed tile: that of its path, then the number of the triangle within its body and the part of it.
std::string tile_id(const Scene& scene, const DiffuseContribution& tile);

class PathLines {
 public:
  /// The scene must outlive it, and may move between the frames. With `top` a line lists so many of its link's paths,
  /// the strongest, and says how many there are.
  PathLines(const Scene& scene, std::span<const Device> receivers, const ResultFacts& facts,
            std::optional<std::size_t> top = {});

  /// Appends the line of a link.
  void append(std::string& text, const FrameResult& frame, const LinkResult& link) const;

 private:
  void append_path(std::string& text, const LinkResult& link, const PathContribution& path) const;
  void append_tile(std::string& text, const LinkResult& link, const DiffuseContribution& tile) const;
  void append_geometry(std::string& text, const Path& path, const std::string& id, double delay_s,
                       std::string_view found_by) const;
  void append_power(std::string& text, const LinkResult& link, const PowerSample& sample) const;
  std::string object_json(BodyId id) const;

  const Scene& scene_;
  ResultFacts facts_;
  std::optional<std::size_t> top_;
  // Names as they stand in the file, prepared once.
  std::vector<std::string> transmitters_, receivers_, bodies_, materials_;
  std::vector<double> power_dbm_;  // of each transmitter
};

}  // namespace dcem::io
