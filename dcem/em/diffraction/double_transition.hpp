#pragma once
/// The transition function of two edges in a row: what F is to one edge, for any spacing of two. For roots α, β ≥ 0 and
/// a correlation −1 < ρ < 1, s = √(1 − ρ²), exp(+jωt):
///   T(α, β, ρ) = −4·s²αβ ∫∫ from 0 to ∞ of e^{−j(2sαt + 2sβu + t² − 2ρtu + u²)} dt du
///              = 2j·s·αβ·[Γ(α + ρβ, sβ) + Γ(β + ρα, sα)],
///   Γ(p, t)    = p ∫ from t to ∞ of e^{−j(τ² − t²)}/(p² + τ²) dτ      (t ≥ 0; odd in p)
/// Γ/2π is the generalized Fresnel integral G(t, p) of Clemmow & Senior (Proc. Camb. Phil. Soc. 49, 1953); T is the
/// function of Capolino, Albani, Maci & Tiberio (AP-45, 1997; Albani, AP-53, 2005) in other variables. The second line
/// follows from the first in polar coordinates about the stationary point of the phase.
///
/// α² and β² are the arguments that F has at each edge when the other is absent, so that
///   ρ = 0 (edges far apart):  T = F(α²)·F(β²);      α, β → ∞ with s·α, s·β: T → 1
///   α, β → 0 (grazing):       T → 2j·s·αβ·(π/2 + arcsin ρ), a field of 1/4 + (arcsin ρ)/2π of the direct one
///   β → ∞:                    T → F(s²α²)
///   T(0⁺, β, ρ)/α + T(0⁺, β, −ρ)/α = 2s√π·e^{jπ/4}·F(β²): across a boundary of one edge the other diffracts alone.
///
/// Evaluation of Γ. p² + t² < 9: a power series (real recurrences, at most 60 terms). Above: Gauss–Laguerre along the
/// path of steepest descent, Γ = −jp/2·∫ e^{−x}/(√(t² − jx)·(p² + t² − jx)) dx, for |p| ≤ t; Γ(p, t) + Γ(t, p) =
/// 2j·E(p)·E(t), E(z) = F(z²)/2jz, brings there what has |p| > t. Relative error of T below 1e-9, measured against 30
/// digits.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "dcem/core/constants.hpp"
#include "dcem/em/complex.hpp"
#include "dcem/em/diffraction/transition_function.hpp"

namespace dcem {

/// How the fields over two neighbouring edges hang together.
struct EdgeCoupling {
  double correlation;  ///< ρ, −1 < ρ < 1; its sign is that of the pair of boundaries
  double complement;   ///< s = √(1 − ρ²) > 0, given apart because ρ goes to 1 where edges are close
};

namespace detail {

struct QuadratureNode {
  double place, weight;
};

// Gauss–Laguerre of 24, 10 and 5 nodes, without weights below 1e-17.
inline constexpr std::array<QuadratureNode, 18> laguerre_near{{{0.059019852181507977, 0.14281197333478185},
                                                               {0.31123914619848373, 0.2587741075174239},
                                                               {0.76609690554593665, 0.2588067072728698},
                                                               {1.4255975908036131, 0.18332268897777802},
                                                               {2.2925620586321903, 0.098166272629918892},
                                                               {3.3707742642089977, 0.040732478151408646},
                                                               {4.6650837034671708, 0.013226019405120157},
                                                               {6.1815351187367654, 0.0033693490584783036},
                                                               {7.9275392471721522, 0.00067216256409354789},
                                                               {9.912098015077706, 0.00010446121465927518},
                                                               {12.146102711729766, 1.2544721977993333e-5},
                                                               {14.642732289596674, 1.1513158127372799e-6},
                                                               {17.417992646508979, 7.9608129591336303e-8},
                                                               {20.491460082616425, 4.0728589875499997e-9},
                                                               {23.887329848169733, 1.5070082262925849e-10},
                                                               {27.635937174332717, 3.9177365150584514e-12},
                                                               {31.776041352374723, 6.8941810529580857e-14},
                                                               {36.358405801651622, 7.8198003824594485e-16}}};
inline constexpr std::array<QuadratureNode, 10> laguerre_middle{{{0.13779347054049243, 0.30844111576502014},
                                                                 {0.7294545495031705, 0.40111992915527355},
                                                                 {1.808342901740316, 0.21806828761180942},
                                                                 {3.4014336978548995, 0.062087456098677747},
                                                                 {5.5524961400638036, 0.0095015169751811006},
                                                                 {8.3301527467644967, 0.00075300838858753878},
                                                                 {11.843785837900066, 2.8259233495995656e-5},
                                                                 {16.279257831378102, 4.2493139849626864e-7},
                                                                 {21.996585811980762, 1.8395648239796308e-9},
                                                                 {29.920697012273892, 9.9118272196090086e-13}}};
inline constexpr std::array<QuadratureNode, 5> laguerre_far{{{0.26356031971814091, 0.52175561058280865},
                                                             {1.4134030591065168, 0.39866681108317593},
                                                             {3.5964257710407221, 0.075942449681707595},
                                                             {7.0858100058588376, 0.0036117586799220485},
                                                             {12.640800844275783, 2.3369972385776228e-5}}};

/// Γ for p² + t² < 9: Σ j^k·(A_k + √π·e^{−j3π/4}·p·B_k), where k·A_k = r²·A_(k−1) + p·t·(2t²)^(k−1)/(2k − 1)!! and
/// (2k + 1)·B_k = 2r²·B_(k−1) + t^(2k)/k!, from A_0 = atan2(p, t), B_0 = 1.
inline Complex corner_integral_series(double p, double t) {
  const double t_squared = t * t, square = p * p + t_squared;
  double angle = std::atan2(p, t), length = 1.0, odd = p * t, even = 1.0;
  Complex angles = angle, lengths = length, turn = 1.0;
  for (int k = 1; k < 60; ++k) {
    even *= t_squared / k;
    angle = (square * angle + odd) / k;
    length = (2.0 * square * length + even) / (2 * k + 1);
    odd *= 2.0 * t_squared / (2 * k + 1);
    turn = {-turn.imag(), turn.real()};
    angles += turn * angle;
    lengths += turn * length;
    if (std::abs(angle) + std::abs(p) * length < 1e-18 * std::abs(p)) break;
  }
  return angles - std::sqrt(0.5 * pi) * p * Complex(1.0, 1.0) * lengths;
}

/// Γ for |p| ≤ t, t² ≥ 4.5.
inline Complex corner_integral_quadrature(double p, double t) {
  const double t_squared = t * t, square = p * p + t_squared;
  std::span<const QuadratureNode> nodes = laguerre_near;
  if (t_squared > 12.0) nodes = laguerre_middle;
  if (t_squared > 30.0) nodes = laguerre_far;
  Complex sum = 0.0;
  for (const auto& [place, weight] : nodes) {
    // √(t² − jx) = u − jv; the two factors multiplied out, and one real division.
    const double u = std::sqrt(0.5 * (std::sqrt(t_squared * t_squared + place * place) + t_squared));
    const double v = 0.5 * place / u;
    const double real = u * square - v * place, imaginary = -(u * place + v * square);
    const double scale = weight / (real * real + imaginary * imaginary);
    sum += Complex(real * scale, -imaginary * scale);
  }
  return Complex(0.0, -0.5 * p) * sum;
}

/// Γ(p, t), t ≥ 0.
inline Complex corner_integral(double p, double t) {
  if (p * p + t * t < 9.0) return corner_integral_series(p, t);
  if (std::abs(p) <= t) return corner_integral_quadrature(p, t);
  // 2j·E(p)·E(t), odd in p.
  const Complex both = Complex(0.0, -0.5) * reduced_transition_function(p * p) * reduced_transition_function(t * t);
  const Complex positive = both - corner_integral(t, std::abs(p));
  return p < 0.0 ? -positive : positive;
}

/// α + ρβ without the loss of digits that it has near ρ = −1.
inline double shifted_root(double root, double other, const EdgeCoupling& coupling) {
  if (coupling.correlation >= 0.0) return root + coupling.correlation * other;
  return (root - other) + coupling.complement * coupling.complement / (1.0 - coupling.correlation) * other;
}

}  // namespace detail

/// T(α, β, ρ)/(αβ), finite where α or β is 0. `first_root` α and `second_root` β finite and ≥ 0. Symmetric in them.
inline Complex reduced_double_transition(double first_root, double second_root, const EdgeCoupling& coupling) {
  // At α = β = 0 the directions of the two arguments count: both 0 would have none.
  const double first = std::max(first_root, 1e-150), second = std::max(second_root, 1e-150);
  const double s = coupling.complement;
  const Complex sum = detail::corner_integral(detail::shifted_root(first, second, coupling), s * second) +
                      detail::corner_integral(detail::shifted_root(second, first, coupling), s * first);
  return Complex(0.0, 2.0 * s) * sum;
}

/// T(α, β, ρ).
inline Complex double_transition_function(double first_root, double second_root, const EdgeCoupling& coupling) {
  return first_root * second_root * reduced_double_transition(first_root, second_root, coupling);
}

}  // namespace dcem
