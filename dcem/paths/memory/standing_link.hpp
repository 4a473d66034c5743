#pragma once
/// A link whose ends stand: every sequence that may carry a path between them, with the way that it takes, so that a
/// frame in which bodies move has to look only at what they come near to.
///
/// Which sequences may carry a path over things that stand is known once and for all; a sequence that the standing
/// scenery itself stops is not kept. A way that comes near to no place at which a changed body was or is has the
/// outcome that it had, to the last bit. Sequences over a body that has moved are found anew.
#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/paths/memory/way_finder.hpp"

namespace dcem {

/// `Outcome` is what a sequence that carries a path brings.
template <typename Outcome>
class StandingLink {
 public:
  struct Entry {
    StandingWay way;
    std::optional<Outcome> outcome;  ///< none: something stops the way
    /// Facets lie on top of each other on the way: the outcome hangs on the ways over the others, too, which may be
    /// elsewhere.
    bool has_choice = false;
  };

  bool is_known() const { return is_known_; }
  void forget() {
    entries_ = {};
    is_known_ = false;
  }
  /// From now on the entries are all that may carry a path.
  void complete() { is_known_ = true; }
  void add(Entry entry) { entries_.push_back(std::move(entry)); }
  std::span<Entry> entries() { return entries_; }

  /// Drops sequences over bodies that have moved.
  template <typename HasMoved>
  void drop(HasMoved&& has_moved) {
    std::erase_if(entries_, [&](const Entry& entry) {
      return std::any_of(entry.way.sequence.begin(), entry.way.sequence.end(), has_moved);
    });
  }

 private:
  std::vector<Entry> entries_;
  bool is_known_ = false;
};

}  // namespace dcem
