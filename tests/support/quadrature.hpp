#pragma once
/// Numerical integration for tests that check a closed form or an engine's sum.
#include <cmath>
#include <utility>
#include <vector>

#include "dcem/core/constants.hpp"

namespace dcem::test {

struct QuadratureNode {
  double at, weight;
};

/// Nodes of Gauss and Legendre on (0, 1), by Newton's method: exact for polynomials up to degree 2·count − 1.
inline std::vector<QuadratureNode> gauss_nodes(int count) {
  std::vector<QuadratureNode> nodes;
  for (int index = 0; index < count; ++index) {
    double x = std::cos(pi * (index + 0.75) / (count + 0.5)), slope = 1.0;
    for (int step = 0; step < 50; ++step) {
      double before = 1.0, value = x;
      for (int k = 2; k <= count; ++k) before = std::exchange(value, ((2 * k - 1) * x * value - (k - 1) * before) / k);
      slope = count * (x * value - before) / (x * x - 1.0);
      x -= value / slope;
    }
    nodes.push_back({0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope)});
  }
  return nodes;
}

}  // namespace dcem::test
