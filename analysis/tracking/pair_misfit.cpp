#include "analysis/tracking/pair_misfit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/base/contracts.h"
#include "render/base/median.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline tracking {
namespace {

constexpr double pooled_freedom = 20;  // weight of the median misfit of all dots, in degrees of freedom

/// Mean square of the odd part of the difference between the residuals of a dot in both frames.
struct PairMisfit {
  double mean = 1;     ///< mean square divided by the variance of the noise of both frames [1]
  double freedom = 0;  ///< degrees of freedom of the mean square; 0: not measured
};

/// Difference between the residuals of a dot in two frames at a pixel of frame A, divided by the noise of both frames.
class ResidualDifference {
 public:
  ResidualDifference(LocatedDots const& a, LocatedDots const& b, LocatedDot const& in_a, LocatedDot const& in_b)
      : a_(a), b_(b), in_a_(in_a), in_b_(in_b) {
    Vec2d const moved = in_b.image.centre - in_a.image.centre;
    dx_ = static_cast<int>(std::lround(moved.x));
    dy_ = static_cast<int>(std::lround(moved.y));
  }

  /// Returns the mean of the dot's centres in both frames, where the centre in frame B is shifted to frame A by whole
  /// pixels [px].
  Vec2d centre() const { return 0.5 * (in_a_.image.centre + in_b_.image.centre - Vec2d{1.0 * dx_, 1.0 * dy_}); }

  /// Returns the difference of the residuals at a pixel of frame A, relative to the noise [1]; NaN if either frame
  /// lacks the pixel.
  double at(int column, int row) const {
    if (!inside(a_.residual, column, row) || !inside(b_.residual, column + dx_, row + dy_)) return not_a_number;
    double const in_a = a_.residual(column, row) - in_a_.background;
    double const in_b = b_.residual(column + dx_, row + dy_) - in_b_.background;
    return (in_b - in_a) / std::hypot(noise_with_light(a_.noise, a_.gain, a_.light(column, row)),
                                      noise_with_light(b_.noise, b_.gain, b_.light(column + dx_, row + dy_)));
  }

 private:
  static bool inside(Image<double> const& image, int column, int row) {
    return column >= 0 && row >= 0 && column < image.columns() && row < image.rows();
  }

  LocatedDots const &a_, &b_;
  LocatedDot const &in_a_, &in_b_;
  int dx_, dy_;
};

PairMisfit measure_pair_misfit(LocatedDots const& a, LocatedDots const& b, LocatedDot const& in_a,
                               LocatedDot const& in_b) {
  ResidualDifference const difference(a, b, in_a, in_b);
  Vec2d const centre = difference.centre();
  double const reach = std::max(2.5, 3.2 * std::sqrt(std::max(in_a.image.xx, in_a.image.yy) + 1.0 / 12) + 0.5);
  int const columns = static_cast<int>(std::lround(2 * centre.x)), rows = static_cast<int>(std::lround(2 * centre.y));
  double sum = 0, pixels = 0;
  for (int row = static_cast<int>(std::ceil(centre.y - reach)); row <= centre.y + reach; ++row)
    for (int column = static_cast<int>(std::ceil(centre.x - reach)); column <= centre.x + reach; ++column) {
      if (!(length(centre - Vec2d{1.0 * column, 1.0 * row}) < reach)) continue;
      // Odd part of the difference; it is zero at a pixel that is its own mirror image.
      double const odd = 0.5 * (difference.at(column, row) - difference.at(columns - column, rows - row));
      if (!std::isfinite(odd)) continue;
      sum += odd * odd;
      ++pixels;
    }
  double const freedom = 0.25 * (in_a.freedom_share + in_b.freedom_share) * pixels;
  return freedom >= 1 ? PairMisfit{sum / freedom, freedom} : PairMisfit{};
}

/// Replaces the misfit of each dot by a weighted mean with the median misfit of all dots, since it is estimated from a
/// few pixels.
void pool_misfits(std::vector<PairMisfit>& misfits) {
  std::vector<double> means;
  // divisor: ratio of the median of a chi2 distribution to its mean
  for (PairMisfit const& one : misfits)
    if (one.freedom > 0) means.push_back(one.mean / std::pow(1 - 2 / (9 * one.freedom), 3));
  if (means.empty()) return;
  double const typical = upper_median(std::move(means));
  for (PairMisfit& one : misfits)
    if (one.freedom > 0)
      one.mean = (one.freedom * one.mean + pooled_freedom * typical) / (one.freedom + pooled_freedom);
}

}  // namespace

std::vector<Vec2d> displacement_sigmas(LocatedDots const& a, LocatedDots const& b, std::span<DotMatch const> matches) {
  GLADSTONE_EXPECTS(matches.size() == a.dots.size());
  std::vector<PairMisfit> misfits(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i)
    if (matches[i].status != MatchStatus::unmatched)
      misfits[i] = measure_pair_misfit(a, b, a.dots[i], b.dots[matches[i].partner]);
  pool_misfits(misfits);
  std::vector<Vec2d> sigmas(matches.size(), {not_a_number, not_a_number});
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (matches[i].status == MatchStatus::unmatched) continue;
    LocatedDot const &in_a = a.dots[i], &in_b = b.dots[matches[i].partner];
    bool const measured = misfits[i].freedom > 0;
    double const factor_a = measured ? std::sqrt(misfits[i].mean) / misfit_factor(in_a) : 1;
    double const factor_b = measured ? std::sqrt(misfits[i].mean) / misfit_factor(in_b) : 1;
    sigmas[i] = {std::hypot(factor_a * in_a.sigma_px.x, factor_b * in_b.sigma_px.x),
                 std::hypot(factor_a * in_a.sigma_px.y, factor_b * in_b.sigma_px.y)};
  }
  return sigmas;
}

}  // namespace gladstone::inline tracking
