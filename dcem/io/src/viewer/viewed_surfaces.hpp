#pragma once
/// The surfaces and edges that the paths of a run touch, once each. Private to dcem::io.
#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "dcem/scene/scene.hpp"

namespace dcem {
struct Interaction;
}

namespace dcem::io {

/// What a path touches, in the axes of the object that it belongs to: it holds wherever the object stands.
struct ViewedSurface {
  std::string object;  ///< empty: the scenery
  MaterialId material;
  Vec3 normal{0.0, 0.0, 1.0};       ///< of a facet, or of face 0 of an edge, on the exterior side
  Vec3 edge{0.0};                   ///< along an edge; zero of a facet
  double exterior_angle_rad = 0.0;  ///< of an edge
};

/// Gives each surface and edge a number, in the order in which they come.
class ViewedSurfaces {
 public:
  std::uint32_t number_of(const Scene& scene, const Interaction& touch);
  const ViewedSurface& operator[](std::uint32_t number) const { return surfaces_[number]; }

 private:
  using Key = std::tuple<std::string, bool, std::uint32_t>;  // object, whether it is an edge, number within the object
  std::map<Key, std::uint32_t> numbers_;
  std::vector<ViewedSurface> surfaces_;
};

}  // namespace dcem::io
