#include <doctest/doctest.h>

#include <array>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include "dcem/core/units.hpp"
#include "dcem/em/diffraction/diffraction_cascade.hpp"
#include "dcem/em/diffraction/wedge_diffraction.hpp"
#include "tests/support/shared_data.hpp"

namespace test_diffraction_cascade {

using namespace dcem;

namespace {

struct ScreenRow {
  double wave_number, first_leg, second_leg, third_leg, first_height, second_height;
  Complex field;
};

// tests/reference/utd_reference.py: Kirchhoff's integral for two screens.
const std::vector<ScreenRow> screen_rows{
#include "tests/reference/utd_double_screen.inc"
};

double loss_db(const Complex& relative_field) {
  return -amplitude_ratio_to_db(std::abs(relative_field));
}

/// A straight edge by a point and a direction, with the wedge around it.
struct RimOnRay {
  Vec3 point;  ///< where the ray meets it
  WedgeFrame frame;
  double n = 2.0;
};

/// Upright half planes with their rims at the given points of the plane y = 0, face 0 towards −x, along y.
std::vector<RimOnRay> screens(const std::vector<Vec3>& rims) {
  std::vector<RimOnRay> edges;
  for (const Vec3& rim : rims) edges.push_back({rim, wedge_frame({0, 0, -1}, {-1, 0, 0})});
  return edges;
}

struct BentRay {
  std::vector<double> legs;
  std::vector<WedgeAngles> angles;
  std::vector<EdgeBases> bases;
  std::vector<double> alignments;
};

BentRay chain_of(const Vec3& source, const std::vector<RimOnRay>& edges, const Vec3& observer) {
  BentRay chain;
  std::vector<Vec3> points{source};
  for (const RimOnRay& edge : edges) points.push_back(edge.point);
  points.push_back(observer);
  for (std::size_t i = 1; i < points.size(); ++i) chain.legs.push_back(glm::distance(points[i], points[i - 1]));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Vec3 incident = glm::normalize(points[i + 1] - points[i]);
    const Vec3 diffracted = glm::normalize(points[i + 2] - points[i + 1]);
    chain.angles.push_back(wedge_angles(edges[i].frame, edges[i].n, incident, diffracted));
    chain.bases.push_back(edge_bases(edges[i].frame.edge, incident, diffracted));
    chain.alignments.push_back(i == 0 ? 1.0 : alignment_of(chain.bases[i - 1], chain.bases[i]));
  }
  return chain;
}

double distance_at(const BentRay& chain, std::size_t edge, CascadeDistances choice) {
  return cascade_distance_parameter_m(choice, chain.legs, chain.alignments, edge, chain.angles[edge].edge_angle_rad);
}

double total_length(const BentRay& chain) {
  double sum = 0.0;
  for (const double leg : chain.legs) sum += leg;
  return sum;
}

/// Scalar field over that of free space along the same length.
Complex scalar_cascade(const BentRay& chain, double k, bool is_hard, CascadeDistances choice, bool slope = true) {
  std::vector<CascadeEdge<Complex>> edges;
  for (std::size_t i = 0; i < chain.angles.size(); ++i) {
    const auto terms = utd_terms_with_slopes(chain.angles[i], k, equal_distances(distance_at(chain, i, choice)));
    edges.push_back({is_hard ? hard_coefficient(terms) : soft_coefficient(terms), chain.angles[i].edge_angle_rad,
                     chain.legs[i + 1], 1.0, chain.alignments[i]});
  }
  return cascade_transfer<Complex>(k, chain.legs[0], edges, slope) * total_length(chain);
}

template <typename Face>
ComplexMatrix2 dyadic_cascade(const BentRay& chain, double k, const Face& face, CascadeDistances choice,
                              LossyWedge variant = LossyWedge::holm_reciprocal, bool slope = true) {
  std::vector<CascadeEdge<ComplexMatrix2>> edges;
  for (std::size_t i = 0; i < chain.angles.size(); ++i) {
    const auto matrices = wedge_matrices(chain.angles[i], face, face, variant);
    const auto m =
        diffraction_matrix_with_slopes(chain.angles[i], k, equal_distances(distance_at(chain, i, choice)), matrices);
    const ComplexMatrix2 arrival =
        i == 0 ? diagonal_matrix(1.0, 1.0) : arrival_matrix(chain.bases[i - 1], chain.bases[i]);
    edges.push_back({m, chain.angles[i].edge_angle_rad, chain.legs[i + 1], arrival, chain.alignments[i]});
  }
  return Complex(total_length(chain)) * cascade_transfer<ComplexMatrix2>(k, chain.legs[0], edges, slope);
}

/// N equal legs at grazing over N − 1 rims of one height.
BentRay grazing(int rims) {
  std::vector<Vec3> points;
  for (int i = 1; i <= rims; ++i) points.push_back({100.0 * i, 0, 0});
  return chain_of({0, 0, 0}, screens(points), {100.0 * (rims + 1), 0, 0});
}

constexpr double wave_number = 600.0;

}  // namespace

TEST_CASE("knife edge: a half plane is within 0.5 dB of J(v) of ITU-R P.526 for |v| < 3") {
  DCEM_NEEDS_SHARED();
  std::ifstream file(test::shared_path("itu/knife_edge_J.csv"));
  std::string line;
  int count = 0;
  double worst = 0.0;
  while (std::getline(file, line)) {
    double v = 0.0;
    double exact_db = 0.0;
    if (std::sscanf(line.c_str(), "%lf,%lf", &v, &exact_db) != 2) continue;
    const double first = 700.0;
    const double second = 300.0;
    const double height = v / std::sqrt(wave_number / pi * (1.0 / first + 1.0 / second));
    const BentRay chain = chain_of({0, 0, 0}, screens({{first, 0, height}}), {first + second, 0, 0});
    for (const bool is_hard : {false, true}) {
      const double detour = wave_number * (total_length(chain) - first - second);
      Complex field = scalar_cascade(chain, wave_number, is_hard, CascadeDistances::ray_optical) * unit_phasor(-detour);
      if (v < 0.0) field += 1.0;
      const double difference = std::abs(loss_db(field) - exact_db);
      CAPTURE(v);
      if (std::abs(v) <= 3.0) REQUIRE(difference <= 0.5);
      if (std::abs(v) <= 3.0) worst = std::max(worst, difference);
    }
    ++count;
  }
  CHECK(count == 17);
  MESSAGE("largest difference " << worst << " dB");
}

TEST_CASE("grazing screens, equally spaced: 1/(N + 1) is 6.02, 9.54, 12.04 dB") {
  for (const bool is_hard : {false, true}) {
    for (const auto choice : {CascadeDistances::symmetric, CascadeDistances::from_source}) {
      const double single = loss_db(scalar_cascade(grazing(1), wave_number, is_hard, choice));
      const double pair = loss_db(scalar_cascade(grazing(2), wave_number, is_hard, choice));
      const double three = loss_db(scalar_cascade(grazing(3), wave_number, is_hard, choice));
      MESSAGE("single " << single << ", double " << pair << ", triple " << three << " dB");
      CHECK(std::abs(single - 6.02) <= 0.1);
      CHECK(pair >= 9.2);
      CHECK(pair <= 9.6);
      CHECK(std::abs(three - 12.04) <= 0.5);
    }
    // Without the slope term, as the literature has it: 12.04 (L from the source) and 13.3 dB (Kouyoumjian & Pathak).
    const double bare = loss_db(scalar_cascade(grazing(2), wave_number, is_hard, CascadeDistances::from_source, false));
    CHECK(std::abs(bare - 12.04) <= 0.2);
    const double weak = loss_db(scalar_cascade(grazing(2), wave_number, is_hard, CascadeDistances::ray_optical, false));
    CHECK(std::abs(weak - 13.3) <= 0.2);
  }
}

/// All rays over two screens, with their phases, over the free-space field: those that bend at both rims, and those
/// that a rim lets pass.
Complex double_screen_field(const ScreenRow& row, bool is_hard, CascadeDistances choice) {
  const double x1 = row.first_leg;
  const double x2 = x1 + row.second_leg;
  const double end = x2 + row.third_leg;
  const Vec3 source(0);
  const Vec3 first(x1, 0, row.first_height);
  const Vec3 second(x2, 0, row.second_height);
  const Vec3 observer(end, 0, 0);
  const auto ray = [&](const std::vector<Vec3>& rims) {
    const BentRay chain = chain_of(source, screens(rims), observer);
    const double detour = row.wave_number * (total_length(chain) - end);
    return scalar_cascade(chain, row.wave_number, is_hard, choice) * unit_phasor(-detour) * (end / total_length(chain));
  };
  Complex field = ray({first, second});
  if (row.first_height < row.second_height * x1 / x2) field += ray({second});
  if (row.second_height < row.first_height * row.third_leg / (end - x1)) field += ray({first});
  return field;
}

TEST_CASE("double screens: within 1.7 dB (L from the source) or 2 dB (symmetric) of Kirchhoff's integral") {
  REQUIRE(screen_rows.size() == 18);
  double worst[3] = {0.0, 0.0, 0.0};
  for (const ScreenRow& row : screen_rows) {
    const auto mean = [&](CascadeDistances choice) {
      return 0.5 * (double_screen_field(row, false, choice) + double_screen_field(row, true, choice));
    };
    const Complex from_source = mean(CascadeDistances::from_source);
    const Complex ray_optical = mean(CascadeDistances::ray_optical);
    const Complex symmetric = mean(CascadeDistances::symmetric);
    const double exact = loss_db(row.field);
    worst[0] = std::max(worst[0], std::abs(loss_db(from_source) - exact));
    worst[1] = std::max(worst[1], std::abs(loss_db(symmetric) - exact));
    worst[2] = std::max(worst[2], std::abs(loss_db(ray_optical) - exact));
  }
  MESSAGE("from the source " << worst[0] << " dB, symmetric " << worst[1] << " dB, ray-optical " << worst[2] << " dB");
  CHECK(worst[0] <= 1.7);
  CHECK(worst[1] <= 2.0);
  CHECK(worst[2] > 3.0);  // what the declared weakness at grazing is
}

TEST_CASE("cascade: on a single edge it is the single diffraction") {
  const BentRay chain = chain_of({0, 0, 0}, screens({{4, 0, 3}}), {9, 0, 1});
  const auto matrices = wedge_matrices(chain.angles[0], perfectly_conducting_face, perfectly_conducting_face);
  for (const auto choice : {CascadeDistances::symmetric, CascadeDistances::from_source, CascadeDistances::from_observer,
                            CascadeDistances::ray_optical}) {
    // s'·s/(s' + s) whatever the choice.
    const double before = 5.0;
    const double after = std::sqrt(29.0);
    CHECK(distance_at(chain, 0, choice) == doctest::Approx(before * after / (before + after)).epsilon(1e-14));
    const ComplexMatrix2 expected =
        Complex((before + after) / std::sqrt(before * after * (before + after))) *
        diffraction_matrix(chain.angles[0], wave_number, equal_distances(before * after / (before + after)), matrices);
    const ComplexMatrix2 got = dyadic_cascade(chain, wave_number, perfectly_conducting_face, choice);
    CHECK(std::sqrt(norm_squared(got + Complex(-1.0) * expected) / norm_squared(expected)) <= 1e-12);
  }
}

TEST_CASE("cascade: at parallel edges the matrix is the scalar soft and hard field, order 2 and 3") {
  const std::vector<Vec3> rims{{100, 0, 0.4}, {160, 0, 1.0}, {290, 0, 0.7}};
  for (const std::size_t order : {std::size_t{2}, std::size_t{3}}) {
    const BentRay chain =
        chain_of({0, 0, 0}, screens({rims.begin(), rims.begin() + static_cast<std::ptrdiff_t>(order)}), {400, 0, 0});
    for (const auto choice : {CascadeDistances::symmetric, CascadeDistances::ray_optical}) {
      const ComplexMatrix2 m = dyadic_cascade(chain, wave_number, perfectly_conducting_face, choice);
      const Complex s = scalar_cascade(chain, wave_number, false, choice);
      const Complex h = scalar_cascade(chain, wave_number, true, choice);
      // Every diffraction is −D, every basis change −1: one sign is left, that of M at a single edge.
      CHECK(std::abs(m(0, 0) + s) <= 1e-12 * std::abs(s));
      CHECK(std::abs(m(1, 1) + h) <= 1e-12 * std::abs(h));
      CHECK(std::abs(m(0, 1)) + std::abs(m(1, 0)) <= 1e-14);
    }
  }
}

TEST_CASE("cascade: spreading of parallel edges is that of the unfolded cylinder product") {
  // With coefficients of 1 only the spreading is left: 1/√(s1·s2·s3·s4·(s1 + s2 + s3 + s4)).
  const WithSlopes<Complex> one{1.0, 0.0, 0.0, 0.0};
  const std::array<CascadeEdge<Complex>, 3> edges{
      {{one, 0.5 * pi, 7.0, 1.0, 1.0}, {one, 0.5 * pi, 2.0, 1.0, -1.0}, {one, 0.5 * pi, 9.0, 1.0, -1.0}}};
  CHECK(cascade_transfer<Complex>(1.0, 4.0, edges).real() ==
        doctest::Approx(1.0 / std::sqrt(4.0 * 7.0 * 2.0 * 9.0 * 22.0)).epsilon(1e-14));
  // Two edges at right angles to each other: the second one's plane holds the curvature across the first, so both
  // principal radii are what they are, ρ_e = s2: 1/s1·√(s1/(s2·(s1 + s2)))·√(s2/(s3·(s2 + s3))).
  const std::array<CascadeEdge<Complex>, 2> crossed{{{one, 0.5 * pi, 7.0, 1.0, 1.0}, {one, 0.5 * pi, 2.0, 1.0, 0.0}}};
  CHECK(cascade_transfer<Complex>(1.0, 4.0, crossed).real() ==
        doctest::Approx(1.0 / 4.0 * std::sqrt(4.0 / (7.0 * 11.0)) * std::sqrt(7.0 / (2.0 * 9.0))).epsilon(1e-14));
}

namespace {

/// The point on each of the edges for the shortest way from end to end, by repeated single-edge unfolding.
void relax(const Vec3& source, std::vector<RimOnRay>& edges, const Vec3& observer) {
  for (int sweep = 0; sweep < 2000; ++sweep)
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const Vec3 a = i == 0 ? source : edges[i - 1].point;
      const Vec3 b = i + 1 == edges.size() ? observer : edges[i + 1].point;
      const Vec3 e = edges[i].frame.edge;
      const double za = glm::dot(a - edges[i].point, e);
      const double zb = glm::dot(b - edges[i].point, e);
      const double da = glm::length(a - edges[i].point - za * e);
      const double db = glm::length(b - edges[i].point - zb * e);
      edges[i].point += (za + (zb - za) * da / (da + db)) * e;
    }
}

}  // namespace

TEST_CASE("reciprocity: a cascade over skew lossy edges, dyadic with slopes, order 2 and 3") {
  const auto face = [](double cosine) { return half_space_reflection({5.24, -0.39}, cosine); };
  const Vec3 source(-6, 2, 0.3);
  const Vec3 observer(14, -3, -0.5);
  const std::vector<RimOnRay> all{
      {{0, 0, 1}, wedge_frame({0.1, 0.0, -1.0}, glm::normalize(Vec3(-1, 0.3, -0.1))), 1.7},
      {{4, 0, 1.8}, wedge_frame({0.0, 0.2, -1.0}, glm::normalize(Vec3(-1, 0.0, 0.0))), 1.8},
      {{9, 0, 1.2}, wedge_frame({0.0, -0.1, -1.0}, glm::normalize(Vec3(-1, -0.4, 0.04))), 1.75}};
  const ComplexMatrix2 sign = diagonal_matrix(1.0, -1.0);
  for (const std::size_t order : {std::size_t{2}, std::size_t{3}}) {
    std::vector<RimOnRay> edges(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(order));
    relax(source, edges, observer);
    const std::vector<RimOnRay> reversed(edges.rbegin(), edges.rend());
    const BentRay there = chain_of(source, edges, observer);
    const BentRay back = chain_of(observer, reversed, source);
    CHECK(std::abs(there.alignments[1]) < 0.999);  // the edges are skew
    for (const WedgeAngles& angles : there.angles)
      CHECK(angles.diffracted_azimuth_rad < angles.exterior_angle_over_pi * pi - 0.05);
    const auto difference = [&](CascadeDistances choice) {
      const ComplexMatrix2 forward = dyadic_cascade(there, wave_number, face, choice);
      const ComplexMatrix2 reverse = sign * transposed(dyadic_cascade(back, wave_number, face, choice)) * sign;
      return std::sqrt(norm_squared(forward + Complex(-1.0) * reverse) / norm_squared(forward));
    };
    CAPTURE(order);
    MESSAGE("order " << order << ": symmetric " << difference(CascadeDistances::symmetric) << ", ray-optical "
                     << difference(CascadeDistances::ray_optical) << ", from the source "
                     << difference(CascadeDistances::from_source));
    CHECK(difference(CascadeDistances::symmetric) <= 1e-12);
    CHECK(difference(CascadeDistances::from_source) > 1e-3);
  }
}

}  // namespace test_diffraction_cascade
