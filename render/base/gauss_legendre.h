#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "render/base/contracts.h"
#include "render/base/units.h"

namespace gladstone::inline base {

/// Nodes and weights of n-point Gauss-Legendre quadrature on [-1, 1], exact for polynomials of degree 2 n - 1
/// (Abramowitz & Stegun 25.4.29). The nodes are computed by Newton's method from the start values cos(pi (i + 3/4) / (n
/// + 1/2)).
struct GaussLegendre {
  std::vector<double> node;    ///< nodes, ascending
  std::vector<double> weight;  ///< weights, of sum 2

  explicit GaussLegendre(int n) : node(static_cast<std::size_t>(n)), weight(static_cast<std::size_t>(n)) {
    GLADSTONE_EXPECTS(n > 0);
    for (int i = 0; i < n; ++i) {
      double x = -std::cos(pi * (i + 0.75) / (n + 0.5));
      double slope = 0;
      for (int iteration = 0; iteration < 100; ++iteration) {
        double previous = 1, value = x;  // values of the Legendre polynomials of degree k - 1 and k
        for (int k = 2; k <= n; ++k) {
          double const next = ((2 * k - 1) * x * value - (k - 1) * previous) / k;
          previous = value;
          value = next;
        }
        slope = n * (x * value - previous) / (x * x - 1);
        double const correction = value / slope;
        x -= correction;
        if (std::abs(correction) < 1e-15) break;
      }
      node[static_cast<std::size_t>(i)] = x;
      weight[static_cast<std::size_t>(i)] = 2 / ((1 - x * x) * slope * slope);
    }
  }
};

}  // namespace gladstone::inline base
