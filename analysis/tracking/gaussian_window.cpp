#include "analysis/tracking/gaussian_window.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "analysis/tracking/nearest_points.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone::inline tracking {
namespace {

constexpr std::size_t local_count = 8;  // number of vectors that determine the local spacing
// largest distance of the vectors that determine the local spacing, in mean spacings
constexpr double local_reach = 30;
constexpr double weight_reach = 2.5;  // radius of the window, in widths H; the weight at this radius is 0.002
constexpr double widest = 3;          // maximum width of the window of a plane fit, relative to the usual width

/// Vectors under a window, with their weights.
struct WeightedVectors {
  std::vector<std::size_t> index;
  Eigen::VectorXd weight;  ///< sums to one
};

/// Computes the weights of the vectors under a window of the given width.
WeightedVectors compute_weights(Vec2d point, std::span<Vec2d const> positions, NearestPoints const& cells,
                                double nearest, double width, WindowOrder order) {
  WeightedVectors result;
  result.index = cells.within(point, std::max(weight_reach * width, 1.0001 * nearest));
  auto const count = static_cast<Eigen::Index>(result.index.size());
  Eigen::MatrixXd terms(count, 3);
  Eigen::VectorXd gaussian(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    Vec2d const at = (positions[result.index[static_cast<std::size_t>(k)]] - point) / width;
    terms.row(k) << 1, at.x, at.y;
    // Compute the weights relative to that of the nearest vector, so that they do not all underflow to zero.
    gaussian[k] = std::exp(nearest * nearest / (width * width) - dot(at, at));
  }
  result.weight = gaussian / gaussian.sum();
  if (order == WindowOrder::mean) return result;
  Eigen::Matrix3d const normal = terms.transpose() * gaussian.asDiagonal() * terms;
  Eigen::LDLT<Eigen::Matrix3d> const solver(normal);
  if (count < 4 || solver.info() != Eigen::Success || !(solver.rcond() > 1e-6)) return {};
  Eigen::Vector3d const first = solver.solve(Eigen::Vector3d(1, 0, 0));
  result.weight = gaussian.asDiagonal() * (terms * first);
  return result;
}

/// Chooses the width of the window at a point, and computes the weights of the vectors in it; empty if no vector is
/// near the point.
WeightedVectors choose_weights(Vec2d point, std::span<Vec2d const> positions, NearestPoints const& cells,
                               GaussianWindow const& window) {
  std::vector<std::size_t> const local = cells.nearest(point, local_count, local_reach * cells.spacing());
  if (local.empty()) return {};
  double const nearest = length(positions[local.front()] - point);
  if (!(nearest <= window.farthest_over_spacing * cells.spacing() * std::numbers::inv_sqrtpi)) return {};
  double const farthest = length(positions[local.back()] - point);
  double const spacing = std::max(farthest / std::sqrt(static_cast<double>(local.size())), 1e-9);
  double const width = window.width_over_spacing * spacing;
  if (window.order == WindowOrder::plane) {
    // If the value of the fitted plane is noisier than a single vector, the plane extrapolates: widen the window.
    for (double wider = width; wider < widest * width; wider *= 1.25) {
      WeightedVectors const plane = compute_weights(point, positions, cells, nearest, wider, WindowOrder::plane);
      if (!plane.index.empty() && plane.weight.squaredNorm() <= 1) return plane;
    }
  }
  return compute_weights(point, positions, cells, nearest, width, WindowOrder::mean);
}

}  // namespace

DisplacementField interpolate_vectors(DisplacementField const& vectors, std::span<Vec2d const> points,
                                      GaussianWindow const& window) {
  GLADSTONE_EXPECTS(window.width_over_spacing > 0);
  std::vector<Vec2d> positions, values, sigmas;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (!vectors.counts(i) || !is_finite(vectors.position_px[i]) || !is_finite(vectors.displacement_px[i])) continue;
    positions.push_back(vectors.position_px[i]);
    values.push_back(vectors.displacement_px[i]);
    sigmas.push_back(vectors.sigma_px.empty() ? Vec2d{not_a_number, not_a_number} : vectors.sigma_px[i]);
  }
  NearestPoints const cells(positions);
  Vec2d const unknown{not_a_number, not_a_number};
  DisplacementField result;
  result.position_px.assign(points.begin(), points.end());
  result.displacement_px.assign(points.size(), unknown);
  result.sigma_px.assign(points.size(), unknown);
  result.status.assign(points.size(), VectorStatus::invalid);
  result.reason.assign(points.size(), VectorReason::no_signal);
  parallel_chunks(points.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!is_finite(points[i]) || positions.empty()) continue;
      WeightedVectors const used = choose_weights(points[i], positions, cells, window);
      if (used.index.empty()) continue;
      Vec2d value{}, variance{};
      for (std::size_t k = 0; k < used.index.size(); ++k) {
        double const weight = used.weight[static_cast<Eigen::Index>(k)];
        Vec2d const sigma = sigmas[used.index[k]];
        value += weight * values[used.index[k]];
        variance += weight * weight * Vec2d{sigma.x * sigma.x, sigma.y * sigma.y};
      }
      result.displacement_px[i] = value;
      result.sigma_px[i] = {std::sqrt(variance.x), std::sqrt(variance.y)};
      result.status[i] = VectorStatus::valid;
      result.reason[i] = VectorReason::measured;
    }
  });
  return result;
}

}  // namespace gladstone::inline tracking
