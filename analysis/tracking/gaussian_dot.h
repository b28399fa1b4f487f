#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/tracking/dot_profile.h"
#include "analysis/tracking/dot_settings.h"
#include "render/base/vec.h"

namespace gladstone::tracking {

/// Image of a dot: a Gaussian, or a round DotProfile. The second moments are those of the irradiance of the widest
/// Gaussian, before the integration over pixels.
struct GaussianDot {
  Vec2d centre{};                 ///< [px]
  double flux = 0;                ///< sum of the levels above the background [grey levels]
  double xx = 1, xy = 0, yy = 1;  ///< second moments about the centre [px^2]; round dots: xx = yy, xy = 0
};

/// Returns the number of parameters that describe the shape: xx, or xx, xy and yy.
constexpr int shape_parameters(DotShape shape) { return shape == DotShape::round ? 1 : 3; }

/// Level of one pixel and its derivatives with respect to the parameters of a dot.
struct DotLevel {
  double value = 0;
  double by_x = 0, by_y = 0, by_flux = 0;
  std::array<double, 3> by_shape{};  ///< with respect to xx (round: of both axes), xy, yy [1/px^2]
};

/// Light of a dot, integrated over each pixel around it. The levels of a round dot are products of one factor
/// per column and one per row, computed by the error function (as in GaussianSpot of the renderers). Those of an
/// elliptic dot are means over 3x3 Gauss-Legendre points; their error is below 1e-4 of the height for widths of 0.6 px
/// and more.
class DotLight {
 public:
  /// @param profile  of round dots; elliptic ones are Gaussian
  /// @pre the second moments are positive definite
  DotLight(GaussianDot const& dot, DotShape shape, DotProfile const& profile) : dot_(dot), shape_(shape) {
    double const sigma = std::sqrt(std::max(dot.xx, dot.yy));
    reach_ = static_cast<int>(std::ceil(5 * sigma + 1));
    first_column_ = static_cast<int>(std::lround(dot.centre.x)) - reach_;
    first_row_ = static_cast<int>(std::lround(dot.centre.y)) - reach_;
    if (shape != DotShape::round) return;
    for (std::size_t k = 0; k < DotProfile::count; ++k) {
      if (profile.share[k] == 0) continue;
      parts_.push_back({profile.share[k], DotProfile::scale[k], factors_.size()});
      double const part_sigma = std::sqrt(DotProfile::scale[k] * dot.xx);
      for (int i = 0; i < width(); ++i) factors_.push_back(factor(first_column_ + i - dot.centre.x, part_sigma));
      for (int i = 0; i < width(); ++i) factors_.push_back(factor(first_row_ + i - dot.centre.y, part_sigma));
    }
  }

  int first_column() const { return first_column_; }
  int first_row() const { return first_row_; }
  int width() const { return 2 * reach_ + 1; }  ///< number of columns and of rows with light [px]

  DotLevel at(int column, int row) const {
    int const i = column - first_column_, j = row - first_row_;
    if (i < 0 || j < 0 || i >= width() || j >= width()) return {};
    if (shape_ == DotShape::elliptic) return elliptic_level(column - dot_.centre.x, row - dot_.centre.y);
    DotLevel level;
    for (Part const& part : parts_) {
      Factor const &u = factors_[part.first + i], &v = factors_[part.first + width() + j];
      level.by_flux += part.share * u.value * v.value;
      level.by_x += part.share * u.by_centre * v.value;
      level.by_y += part.share * u.value * v.by_centre;
      level.by_shape[0] += part.share * part.scale * (u.by_variance * v.value + u.value * v.by_variance);
    }
    level.value = dot_.flux * level.by_flux;
    level.by_x *= dot_.flux;
    level.by_y *= dot_.flux;
    level.by_shape[0] *= dot_.flux;
    return level;
  }

 private:
  /// Fraction of the light in one column or row, and its derivatives.
  struct Factor {
    double value, by_centre, by_variance;
  };

  /// Gaussian of the profile.
  struct Part {
    double share, scale;
    std::size_t first;  ///< of its factors
  };

  /// @param t  pixel minus centre [px]
  static Factor factor(double t, double sigma) {
    constexpr double root_half = 0.5 * std::numbers::sqrt2, per_root_two_pi = std::numbers::inv_sqrtpi * root_half;
    auto const normal = [&](double s) { return per_root_two_pi * std::exp(-0.5 * s * s) / sigma; };
    double const low = (t - 0.5) / sigma, high = (t + 0.5) / sigma;
    double const at_low = normal(low), at_high = normal(high);
    return {0.5 * (std::erf(high * root_half) - std::erf(low * root_half)), at_low - at_high,
            0.5 * (low * at_low - high * at_high) / sigma};
  }

  DotLevel elliptic_level(double x, double y) const {
    constexpr double per_two_pi = 0.5 * std::numbers::inv_pi;
    constexpr std::array<double, 3> place{-0.38729833462074168852, 0, 0.38729833462074168852};
    constexpr std::array<double, 3> weight{5.0 / 18, 8.0 / 18, 5.0 / 18};
    double const determinant = dot_.xx * dot_.yy - dot_.xy * dot_.xy;
    double const a = dot_.yy / determinant, b = -dot_.xy / determinant, c = dot_.xx / determinant;
    double const norm = per_two_pi / std::sqrt(determinant);
    DotLevel level;
    auto const add = [&](double u, double v, double w) {
      double const p = a * u + b * v, q = b * u + c * v, share = w * norm * std::exp(-0.5 * (u * p + v * q));
      level.by_flux += share;
      level.by_x += share * p;
      level.by_y += share * q;
      level.by_shape[0] += 0.5 * share * (p * p - a);
      level.by_shape[1] += share * (p * q - b);
      level.by_shape[2] += 0.5 * share * (q * q - c);
    };
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) add(x + place[i], y + place[j], weight[i] * weight[j]);
    level.value = dot_.flux * level.by_flux;
    level.by_x *= dot_.flux;
    level.by_y *= dot_.flux;
    for (double& by : level.by_shape) by *= dot_.flux;
    return level;
  }

  GaussianDot dot_;
  DotShape shape_;
  int reach_ = 0, first_column_ = 0, first_row_ = 0;
  std::vector<Part> parts_;
  std::vector<Factor> factors_;  // of each part: of the columns, then of the rows
};

}  // namespace gladstone::tracking
