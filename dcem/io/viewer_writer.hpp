#pragma once
/// `viewer.html`: scene, vehicles, devices, rays and maps of a run in one file that a browser opens without a network.
///
/// The file holds three.js, the page and the results as arrays. What a browser can hold at ease is bounded: frames are
/// thinned evenly, of each link the strongest paths are kept, of a map every so many points. The page says what was
/// left out. The same results give the same bytes. docs/design/viewer.md has the format and the reasons.
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "dcem/channel/map_combination.hpp"
#include "dcem/channel/radio_map.hpp"
#include "dcem/io/atomic_file.hpp"
#include "dcem/io/scenario.hpp"
#include "dcem/scene/scene.hpp"
#include "dcem/sim/frame_result.hpp"

namespace dcem::io {

/// Whether three.js was there when the library was built. Without it there is no viewer.
bool viewer_is_built_in();

/// What the page says of the run as a whole.
struct ViewerFacts {
  std::string scenario;  ///< its name
  double frequency_hz = 0.0;
  std::size_t first_frame = 0;           ///< number of the first frame of the run
  std::size_t map_values_per_frame = 0;  ///< of all maps over grids; 0: none
  std::vector<std::string> notes{};      ///< on the results, a line each
};

class ViewerFrames;

/// Collects what the page shows, and writes it after the last frame. Memory is bounded by the settings, not by the
/// length of the run.
class ViewerWriter {
 public:
  /// Opens `viewer.html`. The folder and the scene must outlive the writer, and the scene may move between the frames.
  /// Throws `OutputError`, and std::invalid_argument where this build has no viewer.
  ViewerWriter(OutputFolder& folder, const Scene& scene, ViewerFacts facts, const ViewerSettings& settings);
  ~ViewerWriter();

  /// The next frame, in the order of the run. The scene must stand as the frame says.
  void add(const Frame& frame, const FrameResult& result);
  /// The maps of all transmitters over one grid or list in the frame that was added last, and what they are together.
  /// `has_noise` says what its ratio is: SINR, or SIR.
  void add(std::span<const RadioMap> maps, const CombinedMap& combined, bool has_noise);

  /// After the last frame: writes the file, with `notes` on the results among what the page says. Returns what was left
  /// out, a line each, as the page has it. Throws `OutputError`.
  std::vector<std::string> finish(std::vector<std::string> notes = {});

 private:
  AtomicFile& file_;
  const Scene& scene_;
  ViewerFacts facts_;
  std::unique_ptr<ViewerFrames> frames_;
};

}  // namespace dcem::io
