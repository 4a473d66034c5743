#pragma once
/// How far a map is, told by the points that take time.
#include <atomic>
#include <cstddef>
#include <functional>

namespace dcem::detail {

/// Of a grid over a city more than half of the points may lie inside houses: told at once, they would make the rest
/// look as quick. So each solved point counts for its share of all. Used by several threads at once.
class MapProgress {
 public:
  /// `open` of `points` are to be solved. `tell`, where there is one, is told all `points` in the end.
  MapProgress(const std::function<void(std::size_t)>& tell, std::size_t points, std::size_t open)
      : tell_(tell), points_(points), open_(open) {
    if (tell_ && open_ == 0) tell_(points_);
  }

  /// So many points more are solved.
  void add(std::size_t solved) {
    if (!tell_) return;
    const std::size_t before = solved_.fetch_add(solved);
    tell_((before + solved) * points_ / open_ - before * points_ / open_);
  }

 private:
  const std::function<void(std::size_t)>& tell_;
  std::size_t points_, open_;
  std::atomic<std::size_t> solved_{0};
};

}  // namespace dcem::detail
