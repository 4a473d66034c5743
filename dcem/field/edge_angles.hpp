#pragma once
/// The azimuths of a path's rays about its edges, settled where rounding would decide: on the side of a boundary that
/// the path itself is on, and exactly on a face along which a leg leads (paths/solve/face_leg.hpp).
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/em/diffraction/edge_basis.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/paths/solve/face_leg.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// Scene and path must stay.
class EdgeAngles {
 public:
  /// `from_m` and `to_m` are the two ends of the path.
  EdgeAngles(const Scene& scene, const Path& path, const Vec3& from_m, const Vec3& to_m)
      : scene_(scene), path_(path), from_m_(from_m), to_m_(to_m) {}

  /// At the path's interaction `place`, a diffraction. `directions` of the legs, of unit length.
  WedgeAngles at(std::size_t place, const std::vector<Vec3>& directions) const {
    const Wedge& edge = scene_.wedge(path_.interactions[place].wedge).edge;
    const WedgeAngles angles = wedge_angles({edge_direction(edge), edge.tangent, edge.normal},
                                            edge.exterior_angle_rad / pi, directions[place], directions[place + 1]);
    const bool along_face = face_beside(place, -1) || face_beside(place, 1);
    return along_face ? on_faces(place, angles) : settled(place, angles);
  }

  /// The face along which the leg before (−1) or after (1) an edge leads, from or to another of its edges.
  std::optional<FacetId> face_beside(std::size_t place, int step) const {
    const std::optional<std::size_t> stop = stop_beside(place, step);
    if (!stop || path_.interactions[*stop].kind != InteractionKind::diffraction) return std::nullopt;
    return common_face(scene_.wedge(path_.interactions[place].wedge), scene_.wedge(path_.interactions[*stop].wedge));
  }

 private:
  /// Exact azimuths of legs along a face. What ends there, the direct field and its reflection, ends for both at once.
  WedgeAngles on_faces(std::size_t place, WedgeAngles angles) const {
    const WorldWedge& wedge = scene_.wedge(path_.interactions[place].wedge);
    const auto azimuth_of = [&](FacetId face) {
      return face == wedge.facets[0] ? 0.0 : angles.exterior_angle_over_pi * pi;
    };
    if (const auto face = face_beside(place, -1)) angles.incident_azimuth_rad = azimuth_of(*face);
    if (const auto face = face_beside(place, 1)) angles.diffracted_azimuth_rad = azimuth_of(*face);
    return angles;
  }

  /// Within rounding of a boundary of the direct or of a reflected field, the observer is put on the side on which the
  /// paths take it to be: the path itself says whether the direct one is hidden; a mirror does not reflect within
  /// in_plane_guard_m of its rim.
  WedgeAngles settled(std::size_t place, const WedgeAngles& angles) const {
    const double turn_rad = angles.diffracted_azimuth_rad - angles.incident_azimuth_rad;
    if (std::abs(std::abs(turn_rad) - pi) < shadow_boundary_rad) {
      const double side = path_.interactions[place].in_shadow ? 1.0 : -1.0;
      return moved_to(angles, angles.incident_azimuth_rad + std::copysign(pi + side * beside_rad, turn_rad));
    }
    const double opening_rad = angles.exterior_angle_over_pi * pi;
    const double from_0_rad = angles.incident_azimuth_rad, from_n_rad = opening_rad - from_0_rad;
    if (reflects_at_rim(place, from_0_rad, angles.diffracted_azimuth_rad)) {
      return moved_to(angles, pi + beside_rad - from_0_rad);
    }
    if (reflects_at_rim(place, from_n_rad, opening_rad - angles.diffracted_azimuth_rad)) {
      return moved_to(angles, opening_rad - (pi + beside_rad - from_n_rad));
    }
    return angles;
  }

  /// Whether the point of reflection at a face, from which both azimuths count, lies on its rim.
  bool reflects_at_rim(std::size_t place, double incident_rad, double diffracted_rad) const {
    if (std::abs(incident_rad + diffracted_rad - pi) > rim_search_rad) return false;
    const double incident_m = across_m(place, stop_beside_m(place, -1)),
                 diffracted_m = across_m(place, stop_beside_m(place, 1));
    const double offset_m = incident_m * diffracted_m * std::sin(incident_rad + diffracted_rad) /
                            (diffracted_m * std::sin(diffracted_rad) + incident_m * std::sin(incident_rad));
    return std::abs(offset_m) <= in_plane_guard_m;
  }

  static WedgeAngles moved_to(WedgeAngles angles, double diffracted_azimuth_rad) {
    angles.diffracted_azimuth_rad = diffracted_azimuth_rad;
    return angles;
  }

  /// The interaction before (−1) or after (1) one at which the path turns; none: an end.
  std::optional<std::size_t> stop_beside(std::size_t place, int step) const {
    const std::size_t count = path_.interactions.size();
    for (std::size_t index = place + static_cast<std::size_t>(step); index < count;
         index += static_cast<std::size_t>(step)) {
      if (path_.interactions[index].kind != InteractionKind::transmission) return index;
    }
    return std::nullopt;
  }
  Vec3 stop_beside_m(std::size_t place, int step) const {
    const std::optional<std::size_t> stop = stop_beside(place, step);
    if (stop) return path_.interactions[*stop].point_m;
    return step < 0 ? from_m_ : to_m_;
  }

  double across_m(std::size_t place, const Vec3& point_m) const {
    const Wedge& edge = scene_.wedge(path_.interactions[place].wedge).edge;
    const Vec3 away_m = point_m - path_.interactions[place].point_m;
    return std::hypot(glm::dot(away_m, edge.tangent), glm::dot(away_m, edge.normal));
  }

  static constexpr double beside_rad = 1e-13;  ///< a thousand roundings of an azimuth; of the field it is 1e-13·√(kL)
  static constexpr double rim_search_rad = 1e-3;  ///< farther from a boundary no point of reflection is on the rim

  const Scene& scene_;
  const Path& path_;
  Vec3 from_m_, to_m_;
};

}  // namespace dcem
