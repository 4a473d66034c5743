#pragma once
/// Convex parts of one flat surface, each with the sheets that lie between it and the two ends of a link.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/ids.hpp"
#include "dcem/geometry/vector.hpp"

namespace dcem {

/// Twice the area of a convex polygon in space, m².
inline double twice_area_m2(std::span<const Vec3> corners_m) {
  Vec3 sum(0.0);
  for (std::size_t index = 1; index + 1 < corners_m.size(); ++index) {
    sum += glm::cross(corners_m[index] - corners_m[0], corners_m[index + 1] - corners_m[0]);
  }
  return glm::length(sum);
}

class PartList {
 public:
  /// Numbers of lists of sheets, of the leg from the transmitter and of that to the receiver; 0: no sheet.
  using CrossedLists = std::array<std::uint32_t, 2>;

  void clear() {
    parts_.clear();
    corners_m_.clear();
    lists_.clear();
  }
  /// Takes the polygons out and keeps the lists of sheets.
  void clear_parts() {
    parts_.clear();
    corners_m_.clear();
  }
  void swap_parts(PartList& other) {
    parts_.swap(other.parts_);
    corners_m_.swap(other.corners_m_);
  }

  /// A polygon with at least three corners, in order around it.
  void add(std::span<const Vec3> corners_m, const CrossedLists& crossed) {
    parts_.push_back(
        {static_cast<std::uint32_t>(corners_m_.size()), static_cast<std::uint32_t>(corners_m.size()), crossed});
    corners_m_.insert(corners_m_.end(), corners_m.begin(), corners_m.end());
  }
  /// The number of a new list: `met`, all sheets that a leg meets, and `sheets`, those that count.
  std::uint32_t add_list(std::vector<FacetId> met, std::vector<FacetId> sheets) {
    lists_.push_back({std::move(met), std::move(sheets)});
    return static_cast<std::uint32_t>(lists_.size());
  }

  std::size_t size() const { return parts_.size(); }
  bool empty() const { return parts_.empty(); }
  std::span<const Vec3> corners_m(std::size_t part) const {
    return std::span(corners_m_).subspan(parts_[part].first, parts_[part].count);
  }
  std::span<const Vec3> all_corners_m() const { return corners_m_; }
  const CrossedLists& crossed(std::size_t part) const { return parts_[part].crossed; }
  std::span<const FacetId> sheets(std::uint32_t list) const {
    return list == 0 ? std::span<const FacetId>() : std::span<const FacetId>(lists_[list - 1].sheets);
  }
  /// With those that another one stands for, in the order in which they were met.
  std::span<const FacetId> met(std::uint32_t list) const {
    return list == 0 ? std::span<const FacetId>() : std::span<const FacetId>(lists_[list - 1].met);
  }

 private:
  struct Part {
    std::uint32_t first, count;
    CrossedLists crossed;
  };
  struct SheetList {
    std::vector<FacetId> met, sheets;
  };

  std::vector<Part> parts_;
  std::vector<Vec3> corners_m_;
  std::vector<SheetList> lists_;
};

}  // namespace dcem
