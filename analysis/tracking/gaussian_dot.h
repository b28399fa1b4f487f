#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "analysis/tracking/dot_profile.h"
#include "analysis/tracking/dot_settings.h"
#include "render/base/vec.h"

namespace gladstone::inline tracking {

/// Image of a dot: a Gaussian, or a round DotProfile. The second moments are those of the irradiance of the widest
/// Gaussian, before the integration over pixels.
struct GaussianDot {
  Vec2d centre{};                 ///< position of the centre [px]
  double flux = 0;                ///< sum of the levels above the background [grey levels]
  double xx = 1, xy = 0, yy = 1;  ///< second moments about the centre [px^2]; round dots: xx = yy, xy = 0
};

/// Returns the number of parameters that describe the shape: xx, or xx, xy and yy.
constexpr int shape_parameters(DotShape shape) { return shape == DotShape::round ? 1 : 3; }

/// Level of one pixel and its derivatives with respect to the parameters of a dot.
struct DotLevel {
  double value = 0;
  double by_x = 0, by_y = 0, by_flux = 0;
  /// Derivatives with respect to xx, xy and yy; for round dots, the first one is with respect to xx = yy [1/px^2].
  std::array<double, 3> by_shape{};
};

/// Rectangle of pixels, including its last column and row.
struct PixelBox {
  int left = std::numeric_limits<int>::min(), right = std::numeric_limits<int>::max();
  int top = std::numeric_limits<int>::min(), bottom = std::numeric_limits<int>::max();
};

/// Light of a dot, integrated over each pixel around it. The levels of a round dot are products of one factor
/// per column and one per row, computed by the error function (as in GaussianSpot of the renderers). The levels of an
/// elliptic dot are means over 3x3 Gauss-Legendre points; their error is below 1e-4 of the dot's height for widths of
/// 0.6 px and more.
class DotLight {
 public:
  /// @param profile  profile of round dots; elliptic dots are Gaussian
  /// @param box  pixels at which the light is computed; it is zero at pixels outside
  /// @pre the second moments are positive definite
  DotLight(GaussianDot const& dot, DotShape shape, DotProfile const& profile, PixelBox const& box = {})
      : dot_(dot), shape_(shape) {
    int const reach = static_cast<int>(std::ceil(5 * std::sqrt(std::max(dot.xx, dot.yy)) + 1));
    int const column = static_cast<int>(std::lround(dot.centre.x)), row = static_cast<int>(std::lround(dot.centre.y));
    first_column_ = std::max(column - reach, box.left);
    first_row_ = std::max(row - reach, box.top);
    columns_ = std::max(0, std::min(column + reach, box.right) - first_column_ + 1);
    rows_ = std::max(0, std::min(row + reach, box.bottom) - first_row_ + 1);
    if (shape != DotShape::round) return;
    factors_.reserve(static_cast<std::size_t>(columns_ + rows_) * (profile.gaussian() ? 1 : DotProfile::count));
    for (std::size_t k = 0; k < DotProfile::count; ++k) {
      if (profile.share[k] == 0) continue;
      parts_[part_count_++] = {profile.share[k], DotProfile::scale[k], factors_.size()};
      double const part_sigma = std::sqrt(DotProfile::scale[k] * dot.xx);
      add_factors(first_column_ - dot.centre.x, columns_, part_sigma);
      add_factors(first_row_ - dot.centre.y, rows_, part_sigma);
    }
  }

  int first_column() const { return first_column_; }
  int first_row() const { return first_row_; }
  int columns() const { return columns_; }  ///< number of columns with light
  int rows() const { return rows_; }        ///< number of rows with light

  DotLevel at(int column, int row) const {
    int const i = column - first_column_, j = row - first_row_;
    if (i < 0 || j < 0 || i >= columns_ || j >= rows_) return {};
    if (shape_ == DotShape::elliptic) return elliptic_level(column - dot_.centre.x, row - dot_.centre.y);
    DotLevel level;
    for (Part const& part : std::span(parts_).first(part_count_)) {
      Factor const &u = factors_[part.first + i], &v = factors_[part.first + columns_ + j];
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
  /// Fraction of the light in one column or row, and the derivatives of this fraction.
  struct Factor {
    double value, by_centre, by_variance;
  };

  /// One Gaussian of the profile.
  struct Part {
    double share, scale;
    std::size_t first;  ///< index in factors_ of the first factor of this Gaussian
  };

  /// Values at the edge between two columns or rows.
  struct Edge {
    double place;   ///< distance of the edge from the dot's centre, divided by sigma [1]
    double erf;     ///< error function of place / sqrt(2)
    double normal;  ///< density of the normal distribution at the edge [1/px]
  };

  /// @param t  position of the edge minus that of the dot's centre [px]
  static Edge edge(double t, double sigma) {
    constexpr double root_half = 0.5 * std::numbers::sqrt2, per_root_two_pi = std::numbers::inv_sqrtpi * root_half;
    double const place = t / sigma;
    return {place, std::erf(place * root_half), per_root_two_pi * std::exp(-0.5 * place * place) / sigma};
  }

  /// Appends the factors of adjacent columns or rows.
  /// @param first  centre of the first column or row minus that of the dot [px]
  void add_factors(double first, int count, double sigma) {
    Edge low = edge(first - 0.5, sigma);
    for (int i = 0; i < count; ++i) {
      Edge const high = edge(first + i + 0.5, sigma);
      factors_.push_back({0.5 * (high.erf - low.erf), low.normal - high.normal,
                          0.5 * (low.place * low.normal - high.place * high.normal) / sigma});
      low = high;
    }
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
  int first_column_ = 0, first_row_ = 0, columns_ = 0, rows_ = 0;
  std::array<Part, DotProfile::count> parts_{};
  std::size_t part_count_ = 0;
  std::vector<Factor> factors_;  // factors of each Gaussian: those of the columns, then those of the rows
};

}  // namespace gladstone::inline tracking
