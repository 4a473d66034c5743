#pragma once
/// Frames of a scenario, each read while the one before is worked on.
#include <cstddef>
#include <optional>

#include "dcem/core/beside.hpp"
#include "dcem/io/frame_source.hpp"

namespace dcem::io {

/// Gives the frames `first` to `last`−1 of a source, one after the other. Source and scene must outlive it; the scene
/// may move meanwhile, for a frame does not depend on where it stands.
class FramesAhead {
 public:
  /// `has_thread`: whether another thread reads; otherwise each frame is read when it is asked for.
  FramesAhead(FrameSource& source, const Scene& scene, std::size_t first, std::size_t last, bool has_thread)
      : source_(source), scene_(scene), next_(first), last_(last), has_thread_(has_thread), reading_(has_thread) {}

  /// The next frame; not to be called when all have been given. Throws as `FrameSource::frame` does.
  Frame next() {
    reading_.wait();  // before it is asked whether the frame is there
    if (!read_) read_next();
    reading_.wait();
    Frame frame = std::move(*read_);
    read_.reset();
    if (has_thread_ && next_ < last_) read_next();
    return frame;
  }

 private:
  void read_next() {
    const std::size_t index = next_++;
    reading_.start([this, index] { read_ = source_.frame(scene_, index); });
  }

  FrameSource& source_;
  const Scene& scene_;
  std::size_t next_, last_;
  bool has_thread_;
  std::optional<Frame> read_;  ///< by the thread, until it has been waited for
  Beside reading_;             ///< the first to go
};

}  // namespace dcem::io
