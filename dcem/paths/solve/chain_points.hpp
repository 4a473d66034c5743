#pragma once
/// The points at which a path over a sequence of mirrors and edges touches them, from the geometry of planes and lines
/// alone; whether the surfaces are really there is for the solver to say.
///
/// Without edges: the image method. With edges: what lies behind a mirror is unfolded through it, so that the edges and
/// the two ends form a polyline without mirrors; its shortest form gives the points on the edges; between each two of
/// these the mirrors are folded back by the image method.
#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "dcem/paths/sequence.hpp"
#include "dcem/paths/solve/image_method.hpp"
#include "dcem/paths/solve/wedge_method.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// Holds scratch memory: one per thread.
class ChainPoints {
 public:
  /// False where there is no such path. `images_m`, when given, are those of the receiver in a sequence without edges.
  bool find(const Scene& scene, const Vec3& transmitter_m, const Vec3& receiver_m, const Sequence& sequence,
            const std::vector<Vec3>* images_m);

  /// One per element, from the transmitter to the receiver.
  const std::vector<Vec3>& points_m() const { return points_m_; }

 private:
  bool place_edges(const Scene& scene, const Vec3& transmitter_m, const Vec3& receiver_m, const Sequence& sequence);
  bool fold_back(const Scene& scene, const Vec3& from_m, const Vec3& to_m, std::span<const SequenceElement> mirrors);
  Vec3 unfolded(const Vec3& point_m) const {
    Vec3 image_m = point_m;
    for (auto plane = passed_.rbegin(); plane != passed_.rend(); ++plane) image_m = mirrored(**plane, image_m);
    return image_m;
  }

  std::vector<Vec3> points_m_, segment_points_m_, own_images_m_, edge_points_m_;
  std::vector<const Plane*> passed_;  ///< mirrors between the transmitter and what is being unfolded
};

// ---------------------------------------------------------------------------------------------------------------------

inline bool ChainPoints::find(const Scene& scene, const Vec3& transmitter_m, const Vec3& receiver_m,
                              const Sequence& sequence, const std::vector<Vec3>* images_m) {
  if (images_m != nullptr) {
    const auto plane = [&](std::size_t index) -> const Plane& { return scene.facet(sequence[index].mirror()).plane; };
    return reflection_points(transmitter_m, *images_m, sequence.size(), plane, points_m_);
  }
  points_m_.clear();
  if (!place_edges(scene, transmitter_m, receiver_m, sequence)) return false;
  Vec3 from_m = transmitter_m;
  std::size_t end = sequence.size();  // of the mirrors still to come, counted from the receiver
  for (const Vec3& edge_point_m : edge_points_m_) {
    std::size_t begin = end;
    while (!sequence[begin - 1].is_edge()) --begin;
    if (!fold_back(scene, from_m, edge_point_m, std::span(sequence).subspan(begin, end - begin))) return false;
    points_m_.push_back(edge_point_m);
    from_m = edge_point_m;
    end = begin - 1;
  }
  return fold_back(scene, from_m, receiver_m, std::span(sequence).first(end));
}

/// The points on the edges, into `edge_points_m_`, from the transmitter on.
inline bool ChainPoints::place_edges(const Scene& scene, const Vec3& transmitter_m, const Vec3& receiver_m,
                                     const Sequence& sequence) {
  edge_points_m_.clear();
  passed_.clear();
  std::array<EdgeLine, largest_edge_count> real, image;
  std::size_t count = 0;
  for (auto element = sequence.rbegin(); element != sequence.rend(); ++element) {
    if (!element->is_edge()) {
      passed_.push_back(&scene.facet(element->mirror()).plane);
      continue;
    }
    if (count == largest_edge_count) return false;
    const Wedge& edge = scene.wedge(element->edge()).edge;
    real[count] = {edge.start_m, edge_direction(edge), edge_length_m(edge)};
    const Vec3 start_m = unfolded(edge.start_m);
    image[count] = {start_m, glm::normalize(unfolded(edge.end_m) - start_m), real[count].length_m};
    ++count;
  }
  if (count == 0) return true;
  EdgePlaces places_m{};
  if (!diffraction_places(transmitter_m, std::span(image).first(count), unfolded(receiver_m), places_m)) return false;
  for (std::size_t index = 0; index < count; ++index) edge_points_m_.push_back(real[index].at(places_m[index]));
  return true;
}

/// Appends the points on the mirrors between two points that are known; `mirrors` count from `to_m`.
inline bool ChainPoints::fold_back(const Scene& scene, const Vec3& from_m, const Vec3& to_m,
                                   std::span<const SequenceElement> mirrors) {
  own_images_m_.assign(1, to_m);
  for (const SequenceElement mirror : mirrors) append_image(own_images_m_, scene.facet(mirror.mirror()).plane);
  const auto plane = [&](std::size_t index) -> const Plane& { return scene.facet(mirrors[index].mirror()).plane; };
  if (!reflection_points(from_m, own_images_m_, mirrors.size(), plane, segment_points_m_)) return false;
  points_m_.insert(points_m_.end(), segment_points_m_.begin(), segment_points_m_.end());
  return true;
}

}  // namespace dcem
