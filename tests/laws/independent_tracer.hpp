#pragma once
/// A second ray tracer, for tests alone: it shares no geometry with the engine. Long double, no tree, no beams, no
/// facets, no pruning: every sequence of patches is tried and every patch is asked about every leg.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/law_scenes.hpp"

namespace dcem::test {

using LongVec = glm::vec<3, long double, glm::defaultp>;

struct LongPatch {
  std::vector<LongVec> corners;
  LongVec normal{0.0L};
  bool opaque = true;
};

inline std::vector<LongPatch> long_patches(const Patches& patches) {
  std::vector<LongPatch> result;
  for (const Patch& patch : patches) {
    LongPatch own;
    for (const Vec3& corner : patch.corners_m) own.corners.emplace_back(corner);
    own.normal = glm::normalize(glm::cross(own.corners[1] - own.corners[0], own.corners[2] - own.corners[0]));
    own.opaque = !transmissive(patch.material);
    result.push_back(own);
  }
  return result;
}

inline long double height(const LongPatch& patch, const LongVec& point) {
  return glm::dot(patch.normal, point - patch.corners[0]);
}

/// How far a point of the plane lies inside the convex polygon: negative outside.
inline long double inside_by(const LongPatch& patch, const LongVec& point) {
  LongVec centre(0.0L);
  for (const LongVec& corner : patch.corners) centre += corner / static_cast<long double>(patch.corners.size());
  long double least = std::numeric_limits<long double>::infinity();
  for (std::size_t index = 0; index < patch.corners.size(); ++index) {
    const LongVec &a = patch.corners[index], &b = patch.corners[(index + 1) % patch.corners.size()];
    LongVec inward = glm::normalize(glm::cross(patch.normal, b - a));
    if (glm::dot(inward, centre - a) < 0.0L) inward = -inward;
    least = std::min(least, glm::dot(inward, point - a));
  }
  return least;
}

/// Parameter at which the segment from `a` to `b` meets a triangle, in (0, 1) (Möller and Trumbore 1997).
inline std::optional<long double> meets_triangle(const LongVec& a, const LongVec& b, const LongVec& p, const LongVec& q,
                                                 const LongVec& r) {
  const LongVec direction = b - a, e1 = q - p, e2 = r - p, h = glm::cross(direction, e2);
  const long double determinant = glm::dot(e1, h);
  if (std::fabs(determinant) < 1e-24L) return std::nullopt;
  const LongVec s = a - p, k = glm::cross(s, e1);
  const long double u = glm::dot(s, h) / determinant, v = glm::dot(direction, k) / determinant;
  const long double t = glm::dot(e2, k) / determinant;
  if (u < 0.0L || v < 0.0L || u + v > 1.0L || t <= 0.0L || t >= 1.0L) return std::nullopt;
  return t;
}

/// The same for a patch: the fan of triangles around its first corner.
inline std::optional<long double> meets_patch(const LongVec& a, const LongVec& b, const LongPatch& patch) {
  for (std::size_t corner = 2; corner < patch.corners.size(); ++corner) {
    const auto t = meets_triangle(a, b, patch.corners[0], patch.corners[corner - 1], patch.corners[corner]);
    if (t) return t;
  }
  return std::nullopt;
}

/// A path in terms of patches: letters and patch numbers from the transmitter to the receiver.
struct OwnPath {
  std::string kinds;
  std::vector<std::size_t> patches;
  std::vector<LongVec> points;
  long double length = 0.0L;

  /// For example R3-T7.
  std::string name() const {
    std::string text = kinds.empty() ? "LOS" : "";
    for (std::size_t index = 0; index < kinds.size(); ++index) {
      text += std::string(index > 0 ? "-" : "") + kinds[index] + std::to_string(patches[index]);
    }
    return text;
  }
};

struct OwnSearch {
  std::vector<OwnPath> paths;
  /// Names (without transmissions) of candidates that hang on a margin below `least_margin_m`: here rounding decides.
  std::vector<std::string> doubtful;
};

/// Tries every sequence of patches up to an order.
class IndependentTracer {
 public:
  static constexpr long double least_margin_m = 1e-7L;
  /// What lies along the mirror on which a leg starts or ends, within the weld tolerance, does not count.
  static constexpr long double weld_tolerance_m = 1e-4L;

  IndependentTracer(const Patches& patches, int max_reflections, int max_transmissions)
      : patches_(long_patches(patches)), max_reflections_(max_reflections), max_transmissions_(max_transmissions) {}

  OwnSearch search(const Vec3& transmitter_m, const Vec3& receiver_m) const {
    OwnSearch result;
    std::vector<std::size_t> sequence;
    extend(LongVec(transmitter_m), LongVec(receiver_m), sequence, result);
    return result;
  }

 private:
  enum class Verdict { no, doubtful, yes };

  void extend(const LongVec& from, const LongVec& to, std::vector<std::size_t>& sequence, OwnSearch& result) const {
    OwnPath path;
    const Verdict verdict = solve(from, to, sequence, path);
    if (verdict == Verdict::yes) result.paths.push_back(path);
    if (verdict == Verdict::doubtful) {
      result.doubtful.push_back(OwnPath{std::string(sequence.size(), 'R'), sequence, {}, 0.0L}.name());
    }
    if (sequence.size() == static_cast<std::size_t>(max_reflections_)) return;
    for (std::size_t next = 0; next < patches_.size(); ++next) {
      if (!sequence.empty() && sequence.back() == next) continue;
      sequence.push_back(next);
      extend(from, to, sequence, result);
      sequence.pop_back();
    }
  }

  /// `sequence` runs from the transmitter. The images are those of the transmitter; the path is folded from the
  /// receiver: the other way round than one would write it first, so that no slip is made twice.
  Verdict solve(const LongVec& from, const LongVec& to, const std::vector<std::size_t>& sequence, OwnPath& path) const {
    std::vector<LongVec> images{from};
    for (const std::size_t mirror : sequence) {
      const LongPatch& patch = patches_[mirror];
      images.push_back(images.back() - 2.0L * height(patch, images.back()) * patch.normal);
    }
    std::vector<LongVec> points(sequence.size());
    LongVec target = to;
    Verdict verdict = Verdict::yes;
    for (std::size_t index = sequence.size(); index-- > 0;) {
      const LongPatch& patch = patches_[sequence[index]];
      const long double h_target = height(patch, target), h_image = height(patch, images[index + 1]);
      if (h_target * h_image >= 0.0L) return Verdict::no;
      if (std::min(std::fabs(h_target), std::fabs(h_image)) < least_margin_m) verdict = Verdict::doubtful;
      const long double share = h_target / (h_target - h_image);
      points[index] = target + share * (images[index + 1] - target);
      const long double inside = inside_by(patch, points[index]);
      if (inside < -least_margin_m) return Verdict::no;
      if (inside < least_margin_m) verdict = Verdict::doubtful;
      target = points[index];
    }
    return std::min(verdict, walk(from, to, sequence, points, path));
  }

  Verdict walk(const LongVec& from, const LongVec& to, const std::vector<std::size_t>& sequence,
               const std::vector<LongVec>& points, OwnPath& path) const {
    Verdict verdict = Verdict::yes;
    for (std::size_t leg = 0; leg <= sequence.size(); ++leg) {
      const LongVec a = leg == 0 ? from : points[leg - 1], b = leg == sequence.size() ? to : points[leg];
      const std::size_t none = patches_.size();
      const std::size_t start = leg == 0 ? none : sequence[leg - 1],
                        end = leg == sequence.size() ? none : sequence[leg];
      verdict = std::min(verdict, cross_sheets(a, b, start, end, path));
      if (verdict == Verdict::no) return verdict;
      if (end != none) {
        path.kinds += 'R';
        path.patches.push_back(end);
        path.points.push_back(b);
      }
      path.length += glm::length(b - a);
    }
    const auto crossed = std::count(path.kinds.begin(), path.kinds.end(), 'T');
    return crossed > max_transmissions_ ? Verdict::no : verdict;
  }

  /// Distance of a point of a patch from the mirror along which the patch lies; infinite where it stands on it.
  long double distance_along(const LongPatch& patch, const LongVec& point, std::size_t start, std::size_t end) const {
    long double least = std::numeric_limits<long double>::infinity();
    for (const std::size_t mirror : {start, end}) {
      if (mirror == patches_.size()) continue;
      const bool along = std::fabs(glm::dot(patch.normal, patches_[mirror].normal)) > 0.995L;
      if (along) least = std::min(least, std::fabs(height(patches_[mirror], point)));
    }
    return least;
  }

  /// Adds what one leg crosses, in order.
  Verdict cross_sheets(const LongVec& a, const LongVec& b, std::size_t start, std::size_t end, OwnPath& path) const {
    struct Hit {
      long double t;
      std::size_t patch;
    };
    std::vector<Hit> hits;
    Verdict verdict = Verdict::yes;
    for (std::size_t index = 0; index < patches_.size(); ++index) {
      if (index == start || index == end) continue;
      const LongPatch& patch = patches_[index];
      const long double ha = height(patch, a), hb = height(patch, b);
      if (ha * hb > 0.0L && std::min(std::fabs(ha), std::fabs(hb)) > least_margin_m) continue;
      if (ha == hb) continue;
      const LongVec point = a + ha / (ha - hb) * (b - a);
      const long double inside = inside_by(patch, point);
      if (inside < -least_margin_m) continue;
      const long double contact = distance_along(patch, point, start, end);
      if (contact < weld_tolerance_m - least_margin_m) continue;
      if (inside < least_margin_m || ha * hb >= 0.0L || contact < weld_tolerance_m + least_margin_m) {
        verdict = Verdict::doubtful;
      } else if (patch.opaque) {
        return Verdict::no;
      } else {
        hits.push_back({ha / (ha - hb), index});
      }
    }
    std::sort(hits.begin(), hits.end(), [](const Hit& one, const Hit& other) { return one.t < other.t; });
    for (const Hit& hit : hits) {
      path.kinds += 'T';
      path.patches.push_back(hit.patch);
      path.points.push_back(a + hit.t * (b - a));
    }
    return verdict;
  }

  std::vector<LongPatch> patches_;
  int max_reflections_, max_transmissions_;
};

/// Which patch each facet of the scenery is: the one whose corners are the corners of the facet's hull.
inline std::vector<std::size_t> patch_of_facet(const Scene& scene, const Patches& patches) {
  std::vector<std::size_t> result;
  for (const WorldFacet& facet : scene.facets()) {
    const auto is_corner = [&](const Vec3& point, const Patch& patch) {
      // 1e-9 m: the hull's corners are projected onto the facet's mean plane, which rounding tilts by 1e-15.
      return std::any_of(patch.corners_m.begin(), patch.corners_m.end(),
                         [&](const Vec3& corner) { return glm::distance(point, corner) < 1e-9; });
    };
    const auto hull = scene.hull_m(facet);
    const auto found = std::find_if(patches.begin(), patches.end(), [&](const Patch& patch) {
      return std::all_of(hull.begin(), hull.end(), [&](const Vec3& point) { return is_corner(point, patch); });
    });
    result.push_back(static_cast<std::size_t>(found - patches.begin()));
  }
  return result;
}

/// A path of the engine in terms of patches.
inline OwnPath in_patches(const Path& path, const std::vector<std::size_t>& patch_of) {
  OwnPath own;
  own.kinds = dcem::kinds(path);
  for (const Interaction& interaction : path.interactions) {
    own.patches.push_back(patch_of[interaction.facet.value]);
    own.points.emplace_back(interaction.point_m);
  }
  own.length = path.length_m;
  return own;
}

}  // namespace dcem::test
