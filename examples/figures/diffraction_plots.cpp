/// Diffraction beside what is known of it from elsewhere, as pictures: the exact half plane and the exact right-angled
/// wedge, a walk round a corner of three materials, the knife edge of ITU-R P.526, and the three ways to put lossy
/// faces into the coefficient. Prints the differences, draws diffraction_*.svg, and fails where a difference is beyond
/// the bound of docs/physics.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "dcem/dcem.hpp"
#include "dcem/em/diffraction/wedge_diffraction.hpp"
#include "dcem/em/surface/material_table.hpp"
#include "dcem/io/line_chart.hpp"
#include "dcem/sim/simulator.hpp"

namespace {

using dcem::Complex;
using dcem::pi;
using dcem::unit_phasor;
using Series = dcem::io::LineChart::Series;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

bool all_within_bounds = true;

void report(const std::string& what, double found, double bound, const char* unit) {
  std::printf("%-58s %9.2g %-3s (bound %.2g)\n", what.c_str(), found, unit, bound);
  all_within_bounds = all_within_bounds && found <= bound;
}

double degrees(double radians) {
  return radians * 180.0 / pi;
}

/// `count` values from `first` to `last`, in the middles of as many equal parts: no sample lies on a boundary.
std::vector<double> middles(double first, double last, std::size_t count) {
  std::vector<double> values;
  for (std::size_t index = 0; index < count; ++index) {
    values.push_back(first + (last - first) * (static_cast<double>(index) + 0.5) / static_cast<double>(count));
  }
  return values;
}

template <typename Function>
std::vector<double> mapped(const std::vector<double>& values, Function&& function) {
  std::vector<double> result;
  for (const double value : values) result.push_back(function(value));
  return result;
}

double largest(const std::vector<double>& values) {
  return *std::max_element(values.begin(), values.end());
}

double decibels(const Complex& field) {
  return 20.0 * std::log10(std::abs(field));
}

dcem::io::LineChart chart(std::string title, std::string x_label, std::string x_unit, std::string y_label,
                          std::string y_unit) {
  dcem::io::LineChart made;
  made.title = std::move(title);
  made.x_label = std::move(x_label);
  made.x_unit = std::move(x_unit);
  made.y_label = std::move(y_label);
  made.y_unit = std::move(y_unit);
  return made;
}

void draw(const std::vector<dcem::io::LineChart>& charts, const char* name) {
  dcem::io::write_line_charts(charts, std::string("diffraction_") + name + ".svg");
}

/// A logarithmic axis has no place for 0.
double above_zero(double difference) {
  return std::max(difference, 1e-17);
}

/// ∫ from `a` ≥ 0 to infinity of e^{−jt²} dt, along t = a + s·e^{−jπ/4}, where the integrand decays as e^{−s²}:
/// Gauss–Legendre with eight points on each of 28 pieces up to s = 7, where e^{−s²} is 5e-22.
Complex fresnel_tail_of_positive(double a) {
  constexpr std::array<double, 4> nodes{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
  constexpr std::array<double, 4> weights{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                          0.1012285362903763};
  constexpr double half_piece = 0.125;
  const auto integrand = [a](double s) { return std::exp(-s * s - 2.0 * a * s * unit_phasor(0.25 * pi)); };
  Complex sum = 0.0;
  for (int piece = 0; piece < 28; ++piece) {
    const double middle = half_piece * (2.0 * piece + 1.0);
    for (std::size_t node = 0; node < nodes.size(); ++node) {
      const double offset = half_piece * nodes[node];
      sum += half_piece * weights[node] * (integrand(middle - offset) + integrand(middle + offset));
    }
  }
  return unit_phasor(-a * a - 0.25 * pi) * sum;
}

/// The same for any `a`.
Complex fresnel_tail(double a) {
  const Complex tail = fresnel_tail_of_positive(std::abs(a));
  return a < 0.0 ? std::sqrt(pi) * unit_phasor(-0.25 * pi) - tail : tail;
}

/// Soft (E along the edge) and hard (H along the edge).
struct SoftHard {
  Complex soft, hard;
};

/// Sommerfeld 1896: total field of a plane wave at a conducting half plane.
SoftHard exact_half_plane(double wave_radius, double source_rad, double observer_rad) {
  const auto half = [wave_radius](double azimuth_rad) {
    return unit_phasor(wave_radius * std::cos(azimuth_rad) + 0.25 * pi) / std::sqrt(pi) *
           fresnel_tail(-std::sqrt(2.0 * wave_radius) * std::cos(0.5 * azimuth_rad));
  };
  const Complex direct = half(observer_rad - source_rad), mirror = half(observer_rad + source_rad);
  return {direct - mirror, direct + mirror};
}

/// Total field of a plane wave at a conducting wedge as a sum over the wedge's own waves (Bowman, Senior & Uslenghi):
/// 1/n·Σ ε_m·j^{m/n}·J_{m/n}(kr)·(cos(m(φ − φ')/n) ∓ cos(m(φ + φ')/n)), ε_0 = 1, else 2.
class ExactWedge {
 public:
  ExactWedge(double n, double wave_radius) : n_(n) {
    // Bessel functions of an order well above their argument are below 1e-20.
    const int count = static_cast<int>(n * (wave_radius + 8.0 * std::cbrt(wave_radius) + 30.0));
    for (int m = 0; m < count; ++m) {
      terms_.push_back((m == 0 ? 1.0 : 2.0) / n * unit_phasor(0.5 * pi * m / n) *
                       std::cyl_bessel_j(m / n, wave_radius));
    }
  }

  SoftHard field(double source_rad, double observer_rad) const {
    SoftHard sum;
    for (std::size_t m = 0; m < terms_.size(); ++m) {
      const double order = static_cast<double>(m) / n_;
      const double direct = std::cos(order * (observer_rad - source_rad));
      const double mirror = std::cos(order * (observer_rad + source_rad));
      sum.soft += terms_[m] * (direct - mirror);
      sum.hard += terms_[m] * (direct + mirror);
    }
    return sum;
  }

 private:
  double n_;
  std::vector<Complex> terms_;
};

/// Plane wave at a conducting wedge without diffraction: direct field and reflections at face 0 and face n.
SoftHard geometrical_optics(double n, double wave_radius, double source_rad, double observer_rad) {
  SoftHard field;
  const auto add = [&](double from_rad, double soft_sign) {
    const double turn_rad = observer_rad - from_rad;
    if (std::abs(turn_rad) >= pi) return;
    const Complex wave = unit_phasor(wave_radius * std::cos(turn_rad));
    field.soft += soft_sign * wave;
    field.hard += wave;
  };
  add(source_rad, 1.0);
  add(-source_rad, -1.0);
  add(2.0 * n * pi - source_rad, -1.0);
  return field;
}

/// The same with UTD. Lengths in units of 1/k.
SoftHard utd_total(double n, double wave_radius, double source_rad, double observer_rad) {
  const dcem::UtdTerms terms =
      dcem::utd_terms({n, source_rad, observer_rad, 0.5 * pi}, 1.0, dcem::equal_distances(wave_radius));
  const Complex wave = dcem::diffraction_spreading(infinity, wave_radius) * unit_phasor(-wave_radius);
  SoftHard field = geometrical_optics(n, wave_radius, source_rad, observer_rad);
  field.soft += wave * terms.soft();
  field.hard += wave * terms.hard();
  return field;
}

void half_plane() {
  constexpr double wave_radius = 30.0, source_rad = pi / 3.0;
  const std::vector<double> azimuths_rad = middles(0.0, 2.0 * pi, 720), x = mapped(azimuths_rad, degrees);
  std::array<Series, 3> soft{Series{"Sommerfeld, exact", x}, {"UTD", x}, {"no diffraction", x}}, hard = soft;
  std::array<Series, 2> difference{Series{"E along the edge", x}, {"H along the edge", x}};
  for (const double azimuth_rad : azimuths_rad) {
    const std::array<SoftHard, 3> fields{exact_half_plane(wave_radius, source_rad, azimuth_rad),
                                         utd_total(2.0, wave_radius, source_rad, azimuth_rad),
                                         geometrical_optics(2.0, wave_radius, source_rad, azimuth_rad)};
    for (std::size_t line = 0; line < fields.size(); ++line) {
      soft[line].y.push_back(std::abs(fields[line].soft));
      hard[line].y.push_back(std::abs(fields[line].hard));
    }
    difference[0].y.push_back(above_zero(std::abs(fields[1].soft - fields[0].soft)));
    difference[1].y.push_back(above_zero(std::abs(fields[1].hard - fields[0].hard)));
  }
  for (const Series& line : difference) report("half plane, " + line.name, largest(line.y), 1e-11, "");
  std::vector<dcem::io::LineChart> charts{
      chart("Half plane, plane wave from 60°, kr = 30, E along the edge", "azimuth", "°", "total field", "of incident"),
      chart("The same, H along the edge", "azimuth", "°", "total field", "of incident"),
      chart("UTD less exact", "azimuth", "°", "difference", "of incident")};
  charts[0].series.assign(soft.begin(), soft.end());
  charts[1].series.assign(hard.begin(), hard.end());
  charts[2].series.assign(difference.begin(), difference.end());
  charts[2].y_scale = dcem::io::ChartScale::logarithmic;
  draw(charts, "half_plane");
}

/// Series and UTD over the azimuth, E and H along the edge; the first points, where fringes are dense, left out.
std::vector<dcem::io::LineChart> field_charts(const std::string& title, const std::vector<double>& x, std::size_t first,
                                              const std::vector<SoftHard>& exact, const std::vector<SoftHard>& utd) {
  std::vector<dcem::io::LineChart> charts;
  const auto add = [&](const char* which, Complex SoftHard::*part) {
    charts.push_back(chart(title + which, "azimuth", "°", "total field", "of incident"));
    for (const auto& [name, fields] : {std::pair("series, exact", &exact), std::pair("UTD", &utd)}) {
      Series line{name};
      for (std::size_t index = first; index < x.size(); ++index) {
        line.x.push_back(x[index]);
        line.y.push_back(std::abs((*fields)[index].*part));
      }
      charts.back().series.push_back(std::move(line));
    }
  };
  add(", E along the edge", &SoftHard::soft);
  add(", H along the edge", &SoftHard::hard);
  return charts;
}

void conducting_wedge() {
  constexpr double n = 1.5, source_rad = 50.0 * pi / 180.0, known_error = 0.03;
  const std::vector<double> azimuths_rad = middles(0.0, n * pi, 1080), x = mapped(azimuths_rad, degrees);
  std::vector<dcem::io::LineChart> charts;
  dcem::io::LineChart differences =
      chart("UTD less exact, and the known bound 0.03/kr", "azimuth", "°", "difference", "of incident");
  differences.y_scale = dcem::io::ChartScale::logarithmic;
  for (const double wave_radius : {10.0, 100.0}) {
    const std::string name = "kr = " + std::to_string(static_cast<int>(wave_radius));
    const ExactWedge series(n, wave_radius);
    std::vector<SoftHard> exact, utd;
    Series soft{name + ", E along edge", x}, hard{name + ", H along edge", x};
    for (const double azimuth_rad : azimuths_rad) {
      exact.push_back(series.field(source_rad, azimuth_rad));
      utd.push_back(utd_total(n, wave_radius, source_rad, azimuth_rad));
      soft.y.push_back(above_zero(std::abs(utd.back().soft - exact.back().soft)));
      hard.y.push_back(above_zero(std::abs(utd.back().hard - exact.back().hard)));
    }
    for (Series* line : {&soft, &hard}) {
      report("wedge, " + line->name, largest(line->y), known_error / wave_radius, "");
      differences.series.push_back(std::move(*line));
    }
    differences.series.push_back({name + ", bound", x, std::vector<double>(x.size(), known_error / wave_radius)});
    const std::size_t first = wave_radius > 50.0 ? 400 : 0;
    for (auto& one : field_charts("Wedge of 90°, wave from 50°, " + name, x, first, exact, utd))
      charts.push_back(std::move(one));
  }
  charts.push_back(std::move(differences));
  draw(charts, "wedge");
}

/// Where a walk goes: on a circle of 15 m about the corner, the transmitter 13.4 m away on the other side.
constexpr double walk_radius_m = 15.0;
const dcem::Vec3 transmitter_m(6.0, -12.0, 0.0);

struct CornerMaterial {
  std::string name;
  dcem::MaterialModel model;
  int max_transmissions;
};

/// Field at each azimuth of the walk over that of free space, E along the edge.
std::vector<Complex> walk_round_corner(const CornerMaterial& material, const std::vector<double>& azimuths_rad,
                                       int diffractions) {
  dcem::TriangleMesh walls;
  dcem::add_quad(walls, {dcem::Vec3(0, 0, -50), {0, -60, -50}, {0, -60, 50}, {0, 0, 50}}, "wall");
  dcem::add_quad(walls, {dcem::Vec3(0, 0, -50), {-60, 0, -50}, {-60, 0, 50}, {0, 0, 50}}, "wall");
  dcem::Scene scene;
  scene.add_material({"wall", material.model});
  scene.set_scenery(walls);
  scene.add_transmitter(dcem::device_at("mast", transmitter_m));
  dcem::SimulationSettings settings;
  settings.frequency_hz = 30e9;
  settings.propagation.max_reflections = 1;
  settings.propagation.max_transmissions = material.max_transmissions;
  settings.propagation.max_diffractions = diffractions;
  settings.propagation.discovery = dcem::Discovery::exact;
  std::vector<dcem::Vec3> places_m;
  std::vector<dcem::Device> walker;
  for (const double azimuth_rad : azimuths_rad) {
    places_m.emplace_back(walk_radius_m * std::cos(azimuth_rad), walk_radius_m * std::sin(azimuth_rad), 0.0);
    walker.push_back(dcem::device_at("step" + std::to_string(walker.size()), places_m.back()));
  }
  const double wavelength_m = dcem::speed_of_light_mps / settings.frequency_hz;
  dcem::Simulator simulator(std::move(scene), settings);
  const std::vector<dcem::LinkResult> links = simulator.solve(walker);
  std::vector<Complex> fields;
  for (std::size_t step = 0; step < links.size(); ++step) {
    Complex sum = 0.0;
    for (const dcem::PathContribution& path : links[step].paths) sum += path.transfer(0, 0);
    const double straight_m = glm::distance(transmitter_m, places_m[step]);
    fields.push_back(sum * (4.0 * pi * straight_m / wavelength_m));
  }
  return fields;
}

/// In dB; a gap where there is no field.
std::vector<double> levels_db(const std::vector<Complex>& fields) {
  std::vector<double> levels;
  for (const Complex& field : fields) levels.push_back(field == 0.0 ? nothing : decibels(field));
  return levels;
}

/// The largest step of the amplitude from one sample to the next.
double largest_step(const std::vector<Complex>& fields) {
  double step = 0.0;
  for (std::size_t index = 1; index < fields.size(); ++index)
    step = std::max(step, std::abs(std::abs(fields[index]) - std::abs(fields[index - 1])));
  return step;
}

void corner_walk() {
  const CornerMaterial metal{"metal", dcem::PerfectConductor{}, 0};
  const CornerMaterial concrete{"concrete", dcem::ItuMaterial{"concrete", std::nullopt}, 0};
  const CornerMaterial sheets{"sheets of 5 dB", dcem::ConstantReflection{0.74, 5.0}, 2};
  constexpr double degree = pi / 180.0;
  const double shadow_rad = std::atan2(12.0, -6.0), mirror_rad = std::atan2(12.0, 6.0);
  std::vector<dcem::io::LineChart> charts;
  const auto add = [&](const char* title, const std::vector<double>& azimuths_rad, double step_bound,
                       const std::vector<CornerMaterial>& materials) {
    charts.push_back(chart(title, "azimuth", "°", "field over free space", "dB"));
    const std::vector<double> x = mapped(azimuths_rad, degrees);
    for (const CornerMaterial& material : materials) {
      const std::vector<Complex> total = walk_round_corner(material, azimuths_rad, 1);
      report("walk to " + std::to_string(std::lround(x.back())) + "°, largest step, " + material.name,
             largest_step(total), step_bound, "");
      charts.back().series.push_back({material.name, x, levels_db(total)});
    }
    const std::vector<Complex> alone = walk_round_corner(materials.back(), azimuths_rad, 0);
    std::printf("    the same without diffraction: %.2g\n", largest_step(alone));
    charts.back().series.push_back({"no diffraction", x, levels_db(alone)});
  };
  add("Round a corner at 30 GHz, into the shadow behind 116.6°",
      middles(shadow_rad - 8.0 * degree, 170.0 * degree, 2000), 0.03, {metal, concrete});
  add("The same, a corner of two sheets that can be crossed",
      middles(shadow_rad - 8.0 * degree, shadow_rad + 16.0 * degree, 2000), 0.03, {sheets});
  add("Where the reflection ends, 63.4°", middles(mirror_rad - 0.01, mirror_rad + 0.01, 1500), 0.03, {concrete});
  draw(charts, "corner_walk");
}

void knife_edge() {
  constexpr double wavelength_m = 0.01, before_m = 100.0, after_m = 100.0, n = 2.0, k = 2.0 * pi / wavelength_m;
  const std::vector<double> v = middles(-3.0, 3.0, 600);
  Series itu{"P.526 J(v)", v}, soft{"UTD, E along edge", v}, hard{"UTD, H along edge", v};
  Series soft_difference{"E along edge", v}, hard_difference{"H along edge", v};
  double worst_db = 0.0;
  for (const double place : v) {
    // J(v) = −20·log10 |(1 + j)/2·∫_v^∞ e^{−jπt²/2} dt|, the absolute value of P.526-15, 4.1, equation 30.
    const double exact_db = -decibels(unit_phasor(0.25 * pi) * std::sqrt(0.5) * std::sqrt(2.0 / pi) *
                                      fresnel_tail(place * std::sqrt(0.5 * pi)));
    const double height_m = place / std::sqrt(2.0 / wavelength_m * (1.0 / before_m + 1.0 / after_m));
    const double incident_m = std::hypot(before_m, height_m), diffracted_m = std::hypot(after_m, height_m);
    const double source_rad = std::atan2(before_m, height_m), observer_rad = 2.0 * pi - std::atan2(after_m, height_m);
    const double distance_m = dcem::spherical_distance_parameter_m(incident_m, diffracted_m, 0.5 * pi);
    const dcem::UtdTerms terms =
        dcem::utd_terms({n, source_rad, observer_rad, 0.5 * pi}, k, dcem::equal_distances(distance_m));
    const double detour_m = incident_m + diffracted_m - before_m - after_m;
    const Complex wave = (before_m + after_m) / incident_m * dcem::diffraction_spreading(incident_m, diffracted_m) *
                         unit_phasor(-k * detour_m);
    const double direct = height_m < 0.0 ? 1.0 : 0.0;
    const double soft_db = -decibels(direct + wave * terms.soft()), hard_db = -decibels(direct + wave * terms.hard());
    itu.y.push_back(exact_db);
    soft.y.push_back(soft_db);
    hard.y.push_back(hard_db);
    soft_difference.y.push_back(soft_db - exact_db);
    hard_difference.y.push_back(hard_db - exact_db);
    worst_db = std::max({worst_db, std::abs(soft_db - exact_db), std::abs(hard_db - exact_db)});
  }
  report("knife edge, UTD less J(v) for |v| < 3", worst_db, 0.5, "dB");
  std::vector<dcem::io::LineChart> charts{
      chart("Knife edge half way along 200 m at 30 GHz", "v", "", "diffraction loss", "dB"),
      chart("UTD less P.526", "v", "", "difference", "dB")};
  charts[0].series = {itu, soft, hard};
  charts[1].series = {soft_difference, hard_difference};
  draw(charts, "knife_edge");
}

/// A concrete corner at 28 GHz, both ends 30 m from it.
class ConcreteCorner {
 public:
  /// The matrix of diffraction, at normal incidence.
  dcem::ComplexMatrix2 matrix(double source_rad, double observer_rad, dcem::LossyWedge variant) const {
    const auto concrete = [this](double cosine) { return table_.response(dcem::MaterialId(0), cosine).reflection; };
    return matrix(source_rad, observer_rad, variant, concrete);
  }
  dcem::ComplexMatrix2 conductor(double source_rad, double observer_rad) const {
    return matrix(source_rad, observer_rad, dcem::LossyWedge::reciprocal, dcem::perfectly_conducting_face);
  }

  /// Spreading of the diffracted field over that of the straight way through the corner.
  static double spreading(double source_rad, double observer_rad) {
    const double straight_m = 2.0 * leg_m * std::sin(0.5 * std::abs(observer_rad - source_rad));
    return straight_m / leg_m * dcem::diffraction_spreading(leg_m, leg_m);
  }

 private:
  template <typename Face>
  dcem::ComplexMatrix2 matrix(double source_rad, double observer_rad, dcem::LossyWedge variant,
                              const Face& face) const {
    const dcem::WedgeAngles angles{1.5, source_rad, observer_rad, 0.5 * pi};
    const double distance_m = dcem::spherical_distance_parameter_m(leg_m, leg_m, angles.edge_angle_rad);
    return dcem::diffraction_matrix(angles, dcem::wave_number_rad_per_m(frequency_hz),
                                    dcem::equal_distances(distance_m),
                                    dcem::wedge_matrices(angles, face, face, variant));
  }

  static constexpr double leg_m = 30.0, frequency_hz = 28e9;
  dcem::MaterialTable table_{{{"wall", dcem::ItuMaterial{"concrete", std::nullopt}}}, frequency_hz};
};

void lossy_wedge() {
  constexpr double degree = pi / 180.0, low_rad = 10.0 * degree, high_rad = 60.0 * degree;
  const ConcreteCorner corner;
  const std::vector<double> shadow_rad = middles(low_rad + pi, 268.0 * degree, 800);
  const std::vector<double> around_rad = middles(0.0, 270.0 * degree, 800);
  const std::vector<double> x = mapped(shadow_rad, degrees), around = mapped(around_rad, degrees);
  std::vector<dcem::io::LineChart> charts{
      chart("Concrete corner at 28 GHz, source at 10°, E along the edge", "azimuth", "°", "field over free space",
            "dB"),
      chart("The same, H along the edge", "azimuth", "°", "field over free space", "dB"),
      chart("There less back, one end at 60°, H along the edge", "azimuth", "°", "difference", "dB")};
  const auto add = [&](const std::string& name, auto&& matrix_at) {
    Series soft{name, x}, hard{name, x};
    for (const double azimuth_rad : shadow_rad) {
      const dcem::ComplexMatrix2 matrix = matrix_at(azimuth_rad);
      const double spreading = ConcreteCorner::spreading(low_rad, azimuth_rad);
      soft.y.push_back(decibels(spreading * matrix(0, 0)));
      hard.y.push_back(decibels(spreading * matrix(1, 1)));
    }
    charts[0].series.push_back(std::move(soft));
    charts[1].series.push_back(std::move(hard));
  };
  using Variant = std::pair<std::string, dcem::LossyWedge>;
  for (const auto& [name, variant] :
       {Variant("holm_reciprocal", dcem::LossyWedge::holm_reciprocal),
        Variant("reciprocal", dcem::LossyWedge::reciprocal), Variant("luebbers84", dcem::LossyWedge::luebbers84)}) {
    const dcem::LossyWedge way = variant;
    add(name, [&](double azimuth_rad) { return corner.matrix(low_rad, azimuth_rad, way); });
    charts[2].series.push_back({name, around, mapped(around_rad, [&](double azimuth_rad) {
                                  return decibels(corner.matrix(high_rad, azimuth_rad, way)(1, 1) /
                                                  corner.matrix(azimuth_rad, high_rad, way)(1, 1));
                                })});
    if (way != dcem::LossyWedge::luebbers84)
      report("there less back, " + name,
             largest(mapped(charts[2].series.back().y, [](double y) { return std::abs(y); })), 1e-11, "dB");
  }
  add("conductor", [&](double azimuth_rad) { return corner.conductor(low_rad, azimuth_rad); });
  draw(charts, "lossy_wedge");
}

}  // namespace

int main() {
  half_plane();
  conducting_wedge();
  corner_walk();
  knife_edge();
  lossy_wedge();
  return all_within_bounds ? 0 : 1;
}
