#pragma once
/// The half of a device from frame to frame: what it sees of the scenery is worked out again only where the device has
/// moved.
#include <cstddef>
#include <optional>

#include "dcem/paths/halves/beam_lists.hpp"
#include "dcem/paths/halves/path_half.hpp"

namespace dcem {

/// What is worked out beside a half itself.
struct HalfLists {
  const LaneScene* lanes = nullptr;  ///< none: no lists
  bool over_mirrors = false;         ///< what is reached over mirrors, too
  bool at_once = false;              ///< all of it, now; otherwise of the scenery, when it has become worth while
  std::size_t receivers = 0;         ///< that join the half every time
  ThreadPool* pool = nullptr;        ///< for lists: as in `BeamSource`
};

class KeptHalf {
 public:
  explicit KeptHalf(int map_pixels = PathHalf::default_pixels) : half_(map_pixels) {}

  /// Brings the half to where the device is, and to where the bodies are. The settings are those of the time before.
  void update(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, const HalfSettings& settings,
              const HalfLists& wanted = {}) {
    pass(end, wanted.receivers);
    if (!has_scenery_) find_scenery(scene, outlines, end, settings, wanted.lanes != nullptr && wanted.at_once);
    const bool makes_lists = wanted.lanes != nullptr && !has_lists_ && (wanted.at_once || pay(joins_));
    if (makes_lists && !is_closer_) find_scenery(scene, outlines, end, settings, true);
    half_.find_bodies(scene, outlines, settings);
    if (wanted.lanes == nullptr) return;
    const BeamSource source{scene, outlines, *wanted.lanes, half_, settings, wanted.over_mirrors, wanted.pool};
    if (makes_lists) lists_.find_scenery(source);
    has_lists_ = has_lists_ || makes_lists;
    if (wanted.at_once && !outlines.bodies().empty()) lists_.find_bodies(source);
  }

  /// Notes a frame whose links are known already: what `update` would do for it is left to the next `update`, which
  /// then finds what it would have found.
  void pass(const LinkEnd& end, std::size_t receivers) {
    const bool stands = end_ && end_->position_m == end.position_m && end_->ignored_body == end.ignored_body &&
                        end_->mounted_on == end.mounted_on;
    if (!stands) {
      has_scenery_ = has_lists_ = false;
      joins_ = 0;
    }
    joins_ += receivers;
    end_ = end;
  }

  const PathHalf& half() const { return half_; }
  /// What the device reaches; none where that is not known.
  const BeamLists* lists() const { return has_lists_ ? &lists_ : nullptr; }

 private:
  /// Whether lists would have paid by now: a list costs a fifth of a millisecond per mirror and saves three per join,
  /// by measurement in Munich. At worst both are paid.
  bool pay(std::size_t joins) const { return 16 * joins >= half_.layers()[0].mirrors.size(); }

  /// `closer`: for lists, which take so long for each mirror that it pays to look twice. Others look twice where they
  /// see very much, from above large cities.
  void find_scenery(const Scene& scene, const FacetOutlines& outlines, const LinkEnd& end, HalfSettings settings,
                    bool closer) {
    settings.closer_from = closer ? 0 : very_many;
    half_.find_scenery(scene, outlines, end, settings);
    is_closer_ = closer;
    has_scenery_ = true;
  }

  static constexpr std::size_t very_many = 20'000;  ///< facets; three times what a mast over one city sees

  PathHalf half_;
  BeamLists lists_;
  bool has_scenery_ = false, has_lists_ = false, is_closer_ = false;
  std::size_t joins_ = 0;       ///< since the device stands
  std::optional<LinkEnd> end_;  ///< whose half it is; none yet: nobody's
};

}  // namespace dcem
