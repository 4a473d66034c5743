#pragma once
/// Sheets in front of each other in the pixels of a view: a way that may cross k of them sees nothing behind k + 1.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "dcem/geometry/plane.hpp"

namespace dcem::detail {

/// Each block of pixels holds the k nearest sheets that fill it, nearest first.
class SheetLayers {
 public:
  /// Where a way may cross more sheets than this, sheets hide nothing.
  static constexpr int most_crossed = 10;

  /// A way may cross so many, 1 to `most_crossed`. Parallel sheets that are no farther apart than `pile_m` are one.
  void count(int crossed, double pile_m) {
    crossed_ = static_cast<std::size_t>(crossed);
    pile_m_ = pile_m;
  }
  /// Pixels to a side of a block: 1 for up to three sheets, and 2 for more, as many layers of each pixel take more
  /// memory and time than they are worth. Ten in blocks take as much as two and a half in pixels.
  int block_pixels() const { return crossed_ <= 3 ? 1 : 2; }
  void clear() {
    planes_.clear();
    are_one_.clear();
    layers_.clear();
  }

  /// From now on sheets are those of a plane, `distance_m` in front of the point, in a view of so many blocks; no point
  /// of it is farther away than `reach_m`.
  void take(const Vec3& normal, double distance_m, double reach_m, std::size_t blocks) {
    if (layers_.empty()) layers_.resize(blocks * crossed_);
    planes_.push_back({normal, distance_m, reach_m});
    are_one_.assign(planes_.size(), Answer::not_asked);
  }

  /// A sheet of that plane fills a block. Returns the nearness of the sheet that is one too many; 0: there is none.
  float add(std::size_t block, float nearness) {
    const auto number = static_cast<std::uint32_t>(planes_.size() - 1);
    const std::span<Layer> layers = std::span(layers_).subspan(block * crossed_, crossed_);
    for (const Layer& layer : layers) {
      if (layer.nearness > 0.0F && may_be_last(layer.plane)) return 0.0F;
    }
    Layer added{nearness, number};
    for (Layer& layer : layers) {
      if (layer.nearness < added.nearness) std::swap(layer, added);
    }
    return added.nearness;
  }

 private:
  struct Layer {
    float nearness = 0.0F;  ///< 0: there is none
    std::uint32_t plane = 0;
  };
  struct SheetPlane {
    Vec3 normal;
    double distance_m, reach_m;
  };

  enum class Answer : char { not_asked, no, yes };

  bool may_be_last(std::uint32_t plane) {
    Answer& answer = are_one_[plane];
    if (answer == Answer::not_asked) answer = may_be_one(planes_[plane], planes_.back()) ? Answer::yes : Answer::no;
    return answer == Answer::yes;
  }
  /// A leg counts parallel sheets once that lie within the weld tolerance of each other where it crosses them, and so a
  /// pile or a fan of them. By so much two planes may be apart where they are in view.
  bool may_be_one(const SheetPlane& one, const SheetPlane& other) const {
    constexpr double widest_fan = 0.1;
    const double cosine = glm::dot(one.normal, other.normal);
    const double tilt = std::sqrt(std::max(0.0, 2.0 - 2.0 * std::abs(cosine)));  // the difference of the normals
    const double apart_m = std::abs(one.distance_m - (cosine < 0.0 ? -other.distance_m : other.distance_m));
    return tilt < widest_fan && apart_m <= pile_m_ + tilt * std::max(one.reach_m, other.reach_m);
  }

  std::size_t crossed_ = 1;
  double pile_m_ = 0.0;
  std::vector<SheetPlane> planes_;
  std::vector<Answer> are_one_;  ///< by plane, whether the last one may be the same sheet
  std::vector<Layer> layers_;    ///< by block
};

}  // namespace dcem::detail
