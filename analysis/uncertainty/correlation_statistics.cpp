#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/uncertainty/matched_windows.h"
#include "analysis/uncertainty/pass_amplification.h"

namespace gladstone {
namespace {

/// Terms of the difference have no more in common beyond this distance along an axis than chance makes: the spline that
/// deforms spreads the noise of a pixel over its neighbours, and alternates from there on. Terms so far apart count by
/// half, so that what alternates from pixel to pixel cancels.
constexpr int reach_px = 2;

/// Of a place that is anywhere within a pixel of the highest value [px^2]: a peak that is flat by chance says no more.
constexpr double largest_variance = 1.0 / 3.0;

/// Sum of the products of two values at most reach_px apart along either axis: of terms, the variance of their sum.
double sum_of_products(std::vector<float> const& term, int side, std::vector<float>& across) {
  auto const share = [](int distance) { return std::abs(distance) == reach_px ? 0.5f : 1.0f; };
  across.assign(term.size(), 0.0f);
  for (int j = 0; j < side; ++j)
    for (int d = -reach_px; d <= reach_px; ++d)
      for (int i = std::max(0, -d); i < std::min(side, side - d); ++i)
        across[static_cast<std::size_t>(j) * side + i] += share(d) * term[static_cast<std::size_t>(j) * side + i + d];
  double sum = 0.0;
  for (int j = 0; j < side; ++j)
    for (int k = std::max(0, j - reach_px); k <= std::min(side - 1, j + reach_px); ++k) {
      float line = 0.0f;
      for (int i = 0; i < side; ++i)
        line += term[static_cast<std::size_t>(j) * side + i] * across[static_cast<std::size_t>(k) * side + i];
      sum += static_cast<double>(share(k - j)) * line;
    }
  return sum;
}

/// Variance along an axis: of three points of a Gaussian peak, u = (ln C- - ln C+)/(2 (ln C+ + ln C- - 2 ln C0)), so
/// that sigma_u = sigma(C+ - C-)/(4 C1 ln(C0/C1)), C1 the mean of both. The terms a_i b_(i+1) - a_(i+1) b_i of the
/// difference are s_i d_(i+1) - s_(i+1) d_i of the frames' mean s and difference d, and summed by parts
/// d_i (s_(i-1) - s_(i+1)): the noise of a pixel then stands in one term, while as it is written it stands in two, with
/// opposite signs, whose covariance reaches as far as dots are wide. The frames have been matched by what is judged, so
/// that the sum has lost what it would have been; with the share p_i of a term in the variance, noise being equal
/// everywhere, the sum over pairs of terms has lost the part sum p_i p_k of it, which is made good.
double variance_along(MatchedWindow const& w, int dx, int dy, std::vector<float>& term, std::vector<float>& share,
                      std::vector<float>& scratch) {
  share.assign(w.weight.size(), 0.0f);
  term.assign(w.weight.size(), 0.0f);
  double centre = 0.0, beside = 0.0, overlap = 0.0, whole = 0.0;
  for (std::size_t k = 0; k < w.weight.size(); ++k) {
    centre += static_cast<double>(w.weight[k]) * w.weight[k] * w.reference[k] * w.flow[k];
    whole += static_cast<double>(w.weight[k]) * w.weight[k];
  }
  for (int j = 0; j + dy < w.side; ++j)
    for (int i = 0; i + dx < w.side; ++i) {
      std::size_t const here = w.at(i, j), there = w.at(i + dx, j + dy);
      float const weight = w.weight[here] * w.weight[there];
      float const sum_here = w.reference[here] + w.flow[here], sum_there = w.reference[there] + w.flow[there];
      share[here] -= 0.5f * weight * sum_there;
      share[there] += 0.5f * weight * sum_here;
      beside +=
          0.5 * static_cast<double>(weight) * (w.reference[here] * w.flow[there] + w.reference[there] * w.flow[here]);
      overlap += static_cast<double>(weight);
    }
  // as the correlator has it: the fall-off of the weights divided out
  beside *= whole / overlap;
  if (!(beside > 0.0 && centre > beside)) return std::numeric_limits<double>::quiet_NaN();
  double const slope = 4.0 * beside * std::log(centre / beside) * overlap / whole;
  float squares = 0.0f;
  for (std::size_t k = 0; k < term.size(); ++k) {
    term[k] = share[k] * (w.flow[k] - w.reference[k]);
    share[k] *= share[k];
    squares += share[k];
  }
  double const lost = sum_of_products(share, w.side, scratch) / (static_cast<double>(squares) * squares);
  double const variance = sum_of_products(term, w.side, scratch) / ((1.0 - lost) * slope * slope);
  return std::clamp(variance, 0.0, largest_variance);
}

}  // namespace

std::vector<Vec2d> correlation_statistics(UncertaintyInput const& input) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  double const amplification = amplification_of_passes(input.settings), squared = amplification * amplification;
  std::vector<double> u(input.field.size(), nan), v = u;
  visit_matched_windows(input, [&](std::size_t i, MatchedWindow const& window) {
    thread_local std::vector<float> term, share;
    thread_local std::vector<float> scratch;
    u[i] = squared * variance_along(window, 1, 0, term, share, scratch);
    v[i] = squared * variance_along(window, 0, 1, term, share, scratch);
  });
  return sigma_of_variances(u, v, input.grid);
}

}  // namespace gladstone
