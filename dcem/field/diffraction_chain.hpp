#pragma once
/// The transfer of a path with diffractions: reflections and transmissions along straight legs, and the cascade of its
/// edges (em/diffraction/diffraction_cascade.hpp).
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/em/diffraction/diffraction_cascade.hpp"
#include "dcem/em/diffraction/wedge_diffraction.hpp"
#include "dcem/em/surface/material_table.hpp"
#include "dcem/field/field_carrier.hpp"
#include "dcem/paths/path.hpp"
#include "dcem/scene/scene.hpp"

namespace dcem {

/// How the field of a diffracted path is computed.
struct DiffractionModel {
  LossyWedge lossy_wedge = LossyWedge::holm_reciprocal;
  /// Sheets that paths may cross: faces through which the direct field passes are half-transparent to the diffracted
  /// one.
  int max_transmissions = 0;
};

/// All edges of one path.
template <SurfaceModel Surface>
class DiffractionChain {
 public:
  /// `from_m` and `to_m` are the two ends of the path.
  DiffractionChain(const Scene& scene, const Surface& surface, const DiffractionModel& model, const Path& path,
                   const std::vector<Vec3>& directions, const Vec3& from_m, const Vec3& to_m,
                   double wave_number_rad_per_m)
      : scene_(scene),
        surface_(surface),
        model_(model),
        path_(path),
        directions_(directions),
        from_m_(from_m),
        to_m_(to_m),
        carrier_(scene, surface, path, directions),
        wave_number_rad_per_m_(wave_number_rad_per_m) {
    measure_legs();
    for (const std::size_t place : places_) add_edge(place);
  }

  /// What arrives along the unit vectors `received` per unit field along `sent` a metre from the transmitter, in 1/m:
  /// everything but the phase of the path's length.
  ComplexMatrix2 transfer(const std::array<Vec3, 2>& sent, const std::array<Vec3, 2>& received) const {
    return leaving(received) * (cascade() * arriving(sent));
  }

 private:
  struct Edge {
    EdgeBases bases;
    WedgeAngles angles;
    WedgeMatrices matrices;
    ComplexMatrix2 arrival;
    double alignment = 1.0;
  };

  /// Where the edges stand among the interactions, and how long the ways between them are.
  void measure_legs() {
    Vec3 before_m = from_m_;
    double length_m = 0.0;
    for (std::size_t index = 0; index < path_.interactions.size(); ++index) {
      const Interaction& interaction = path_.interactions[index];
      length_m += glm::distance(before_m, interaction.point_m);
      before_m = interaction.point_m;
      if (interaction.kind != InteractionKind::diffraction) continue;
      places_.push_back(index);
      legs_m_.push_back(std::exchange(length_m, 0.0));
    }
    legs_m_.push_back(length_m + glm::distance(before_m, to_m_));
  }

  void add_edge(std::size_t place) {
    const WorldWedge& wedge = scene_.wedge(path_.interactions[place].wedge);
    const Vec3 along = edge_direction(wedge.edge);
    Edge edge;
    edge.bases = edge_bases(along, directions_[place], directions_[place + 1]);
    edge.angles =
        settled(place, wedge_angles({along, wedge.edge.tangent, wedge.edge.normal}, wedge.edge.exterior_angle_rad / pi,
                                    directions_[place], directions_[place + 1]));
    edge.matrices = wedge_matrices(edge.angles, reflection_of(wedge.facets[0]), reflection_of(wedge.facets[1]),
                                   model_.lossy_wedge, transmission_of(wedge, edge.angles));
    edge.arrival = edges_.empty() ? diagonal_matrix(1.0, 1.0) : arrival_at(edge.bases, place);
    edge.alignment = edges_.empty() ? 1.0 : alignment_at(edge.bases, place);
    edges_.push_back(edge);
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

  /// The point before (−1) or after (1) an interaction at which the path turns, or its end.
  Vec3 stop_beside_m(std::size_t place, int step) const {
    const std::size_t count = path_.interactions.size();
    for (std::size_t index = place + static_cast<std::size_t>(step); index < count;
         index += static_cast<std::size_t>(step)) {
      if (path_.interactions[index].kind != InteractionKind::transmission) return path_.interactions[index].point_m;
    }
    return step < 0 ? from_m_ : to_m_;
  }

  double across_m(std::size_t place, const Vec3& point_m) const {
    const Wedge& edge = scene_.wedge(path_.interactions[place].wedge).edge;
    const Vec3 away_m = point_m - path_.interactions[place].point_m;
    return std::hypot(glm::dot(away_m, edge.tangent), glm::dot(away_m, edge.normal));
  }

  auto reflection_of(FacetId facet) const {
    return [this, material = scene_.facet(facet).material](double cos_incidence) {
      return surface_.response(material, cos_incidence).reflection;
    };
  }
  auto passage_of(FacetId facet) const {
    return [this, material = scene_.facet(facet).material](double cos_incidence) {
      return surface_.response(material, cos_incidence).transmission;
    };
  }

  /// What the faces let through of the direct field; nothing where one of them is opaque or paths may not cross them.
  std::optional<ComplexMatrix2> transmission_of(const WorldWedge& wedge, const WedgeAngles& angles) const {
    const int sheets = is_free(wedge.edge) ? 1 : 2;
    const bool opaque = !scene_.facet(wedge.facets[0]).transmits || !scene_.facet(wedge.facets[1]).transmits;
    if (opaque || sheets > transmissions_left()) return std::nullopt;
    if (sheets == 1) return face_transmission_matrix(angles, WedgeFace::zero, passage_of(wedge.facets[0]));
    return wedge_transmission_matrix(angles, passage_of(wedge.facets[0]), passage_of(wedge.facets[1]));
  }

  /// Sheets that the direct path beside the edge may cross beyond those that this path crosses already.
  int transmissions_left() const {
    int left = model_.max_transmissions;
    for (const Interaction& interaction : path_.interactions) {
      left -= interaction.kind == InteractionKind::transmission ? 1 : 0;
    }
    return left;
  }

  ComplexMatrix2 arrival_at(const EdgeBases& here, std::size_t place) const {
    const std::size_t first = places_[edges_.size() - 1] + 1;
    const EdgeBases& before = edges_.back().bases;
    const ComplexVector2 beta =
        incident_components(here, carrier_.carry(ComplexVector3(before.diffracted_beta), first, place));
    const ComplexVector2 phi =
        incident_components(here, carrier_.carry(ComplexVector3(before.diffracted_phi), first, place));
    return {{{{beta[0], phi[0]}, {beta[1], phi[1]}}}};
  }

  double alignment_at(const EdgeBases& here, std::size_t place) const {
    const std::size_t first = places_[edges_.size() - 1] + 1;
    return glm::dot(here.incident_phi, carrier_.turned(edges_.back().bases.diffracted_phi, first, place));
  }

  ComplexMatrix2 cascade() const {
    std::vector<CascadeEdge<ComplexMatrix2>> edges;
    for (std::size_t index = 0; index < edges_.size(); ++index) {
      const Edge& edge = edges_[index];
      edges.push_back({edge.angles, edge.matrices.in_order(), legs_m_[index + 1], edge.arrival, edge.alignment});
    }
    return cascade_transfer<ComplexMatrix2>(wave_number_rad_per_m_, legs_m_[0], edges);
  }

  /// From the transmitter's unit vectors to the basis in which the first edge is met.
  ComplexMatrix2 arriving(const std::array<Vec3, 2>& sent) const {
    ComplexMatrix2 matrix;
    for (std::size_t in = 0; in < 2; ++in) {
      const ComplexVector2 components =
          incident_components(edges_.front().bases, carrier_.carry(ComplexVector3(sent[in]), 0, places_.front()));
      for (std::size_t row = 0; row < 2; ++row) matrix(row, in) = components[row];
    }
    return matrix;
  }

  /// From the basis that leaves the last edge to the receiver's unit vectors.
  ComplexMatrix2 leaving(const std::array<Vec3, 2>& received) const {
    const EdgeBases& bases = edges_.back().bases;
    const std::array<Vec3, 2> basis{bases.diffracted_beta, bases.diffracted_phi};
    ComplexMatrix2 matrix;
    for (std::size_t column = 0; column < 2; ++column) {
      const ComplexVector3 field =
          carrier_.carry(ComplexVector3(basis[column]), places_.back() + 1, path_.interactions.size());
      for (std::size_t out = 0; out < 2; ++out) matrix(out, column) = dot(field, received[out]);
    }
    return matrix;
  }

  static constexpr double beside_rad = 1e-13;  ///< a thousand roundings of an azimuth; of the field it is 1e-13·√(kL)
  static constexpr double rim_search_rad = 1e-3;  ///< farther from a boundary no point of reflection is on the rim

  const Scene& scene_;
  const Surface& surface_;
  const DiffractionModel& model_;
  const Path& path_;
  const std::vector<Vec3>& directions_;
  Vec3 from_m_, to_m_;
  FieldCarrier<Surface> carrier_;
  double wave_number_rad_per_m_;
  std::vector<std::size_t> places_;  ///< of the diffractions among the interactions
  std::vector<double> legs_m_;       ///< unfolded, from the transmitter over the edges to the receiver
  std::vector<Edge> edges_;
};

}  // namespace dcem
