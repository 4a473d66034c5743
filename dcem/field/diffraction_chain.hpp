#pragma once
/// The transfer of a path with diffractions: reflections and transmissions along straight legs, and the cascade of its
/// edges (em/diffraction/diffraction_cascade.hpp).
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "dcem/core/constants.hpp"
#include "dcem/core/error.hpp"
#include "dcem/em/diffraction/diffraction_cascade.hpp"
#include "dcem/em/diffraction/wedge_diffraction.hpp"
#include "dcem/em/surface/material_table.hpp"
#include "dcem/field/edge_angles.hpp"
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
        angles_(scene, path, from_m, to_m),
        carrier_(scene, surface, path, directions),
        wave_number_rad_per_m_(wave_number_rad_per_m) {
    measure_legs();
    for (std::size_t edge = 0; edge < count_; ++edge) place_edge(edge);
  }

  /// What arrives along the unit vectors `received` per unit field along `sent` a metre from the transmitter, in 1/m:
  /// everything but the phase of the path's length.
  ComplexMatrix2 transfer(const std::array<Vec3, 2>& sent, const std::array<Vec3, 2>& received) const {
    return leaving(received) * (cascade() * arriving(sent));
  }

 private:
  static constexpr std::size_t most_edges = most_cascade_edges;
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
      DCEM_ASSERT(count_ < most_edges);
      places_[count_] = index;
      legs_m_[count_++] = std::exchange(length_m, 0.0);
    }
    legs_m_[count_] = length_m + glm::distance(before_m, to_m_);
  }

  void place_edge(std::size_t number) {
    const std::size_t place = places_[number];
    const WorldWedge& wedge = scene_.wedge(path_.interactions[place].wedge);
    Edge& edge = edges_[number];
    edge.bases = edge_bases(edge_direction(wedge.edge), directions_[place], directions_[place + 1]);
    edge.angles = angles_.at(place, directions_);
    edge.matrices = matrices_at(place, wedge, edge.angles);
    edge.arrival = number == 0 ? diagonal_matrix(1.0, 1.0) : arrival_at(number);
    edge.alignment = number == 0 ? 1.0 : alignment_at(number);
  }

  /// What arrives along a face holds the wave and its reflection: the terms with that reflection would count it twice.
  /// Only in holm_reciprocal every term has its image in each face, whatever the face is of.
  WedgeMatrices matrices_at(std::size_t place, const WorldWedge& wedge, const WedgeAngles& angles) const {
    const std::optional<FacetId> before = angles_.face_beside(place, -1);
    const bool along_face = before || angles_.face_beside(place, 1);
    const WedgeMatrices all =
        wedge_matrices(angles, reflection_of(wedge.facets[0]), reflection_of(wedge.facets[1]),
                       along_face ? LossyWedge::holm_reciprocal : model_.lossy_wedge, transmission_of(wedge, angles));
    if (!before) return all;
    return all.without_reflection_at(*before == wedge.facets[0] ? WedgeFace::zero : WedgeFace::n);
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

  /// From the edge before to one of them, that one excluded.
  ComplexMatrix2 arrival_at(std::size_t number) const {
    const EdgeBases &here = edges_[number].bases, &before = edges_[number - 1].bases;
    const auto carried =
        carrier_.carry(std::array{ComplexVector3(before.diffracted_beta), ComplexVector3(before.diffracted_phi)},
                       places_[number - 1] + 1, places_[number]);
    const ComplexVector2 beta = incident_components(here, carried[0]), phi = incident_components(here, carried[1]);
    return {{{{beta[0], phi[0]}, {beta[1], phi[1]}}}};
  }

  double alignment_at(std::size_t number) const {
    return glm::dot(edges_[number].bases.incident_phi,
                    carrier_.turned(edges_[number - 1].bases.diffracted_phi, places_[number - 1] + 1, places_[number]));
  }

  ComplexMatrix2 cascade() const {
    std::array<CascadeEdge<ComplexMatrix2>, most_edges> edges;
    for (std::size_t index = 0; index < count_; ++index) {
      const Edge& edge = edges_[index];
      edges[index] = {edge.angles, edge.matrices.in_order(), legs_m_[index + 1], edge.arrival, edge.alignment};
    }
    return cascade_transfer<ComplexMatrix2>(wave_number_rad_per_m_, legs_m_[0], std::span(edges).first(count_));
  }

  /// From the transmitter's unit vectors to the basis in which the first edge is met.
  ComplexMatrix2 arriving(const std::array<Vec3, 2>& sent) const {
    const auto carried =
        carrier_.carry(std::array{ComplexVector3(sent[0]), ComplexVector3(sent[1])}, 0, places_.front());
    ComplexMatrix2 matrix;
    for (std::size_t in = 0; in < 2; ++in) {
      const ComplexVector2 components = incident_components(edges_.front().bases, carried[in]);
      for (std::size_t row = 0; row < 2; ++row) matrix(row, in) = components[row];
    }
    return matrix;
  }

  /// From the basis that leaves the last edge to the receiver's unit vectors.
  ComplexMatrix2 leaving(const std::array<Vec3, 2>& received) const {
    const EdgeBases& bases = edges_[count_ - 1].bases;
    const auto carried =
        carrier_.carry(std::array{ComplexVector3(bases.diffracted_beta), ComplexVector3(bases.diffracted_phi)},
                       places_[count_ - 1] + 1, path_.interactions.size());
    ComplexMatrix2 matrix;
    for (std::size_t column = 0; column < 2; ++column) {
      for (std::size_t out = 0; out < 2; ++out) matrix(out, column) = dot(carried[column], received[out]);
    }
    return matrix;
  }

  const Scene& scene_;
  const Surface& surface_;
  const DiffractionModel& model_;
  const Path& path_;
  const std::vector<Vec3>& directions_;
  Vec3 from_m_, to_m_;
  EdgeAngles angles_;
  FieldCarrier<Surface> carrier_;
  double wave_number_rad_per_m_;
  std::size_t count_ = 0;                         ///< of edges
  std::array<std::size_t, most_edges> places_{};  ///< of the diffractions among the interactions
  std::array<double, most_edges + 1> legs_m_{};   ///< unfolded, from the transmitter over the edges to the receiver
  std::array<Edge, most_edges> edges_;
};

}  // namespace dcem
