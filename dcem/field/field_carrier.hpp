#pragma once
/// What reflections and transmissions along a path do to a field.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "dcem/em/dyad.hpp"
#include "dcem/em/surface/material_table.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// Follows fields along a path. `directions` are the unit propagation directions of its legs, one more than there are
/// interactions.
template <SurfaceModel Surface>
class FieldCarrier {
 public:
  FieldCarrier(const Scene& scene, const Surface& surface, const Path& path, const std::vector<Vec3>& directions)
      : scene_(scene), surface_(surface), path_(path), directions_(directions) {}

  /// The fields after the interactions first … last−1, which are reflections and transmissions.
  template <std::size_t count>
  std::array<ComplexVector3, count> carry(std::array<ComplexVector3, count> fields, std::size_t first,
                                          std::size_t last) const {
    for (std::size_t index = first; index < last; ++index) {
      const Interaction& interaction = path_.interactions[index];
      const WorldFacet& facet = scene_.facet(interaction.facet);
      const Vec3& direction = directions_[index];
      const double cos_incidence = std::min(1.0, std::abs(glm::dot(direction, facet.plane.normal)));
      const SurfaceResponse response = surface_.response(facet.material, cos_incidence);
      const IncidenceBasis basis = incidence_basis(direction, facet.plane.normal);
      const bool is_reflected = interaction.kind == InteractionKind::reflection;
      for (ComplexVector3& field : fields) {
        field =
            is_reflected ? reflect(field, basis, response.reflection) : transmit(field, basis, response.transmission);
      }
    }
    return fields;
  }

  /// A direction across the ray, turned by the mirrors on the way as a picture would be.
  Vec3 turned(Vec3 across, std::size_t first, std::size_t last) const {
    for (std::size_t index = first; index < last; ++index) {
      if (path_.interactions[index].kind != InteractionKind::reflection) continue;
      across = reflected_direction(across, scene_.facet(path_.interactions[index].facet).plane.normal);
    }
    return across;
  }

 private:
  const Scene& scene_;
  const Surface& surface_;
  const Path& path_;
  const std::vector<Vec3>& directions_;
};

}  // namespace dcem
