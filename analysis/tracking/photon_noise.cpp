#include "analysis/tracking/photon_noise.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "render/base/median.h"

namespace gladstone::inline tracking {
namespace {

constexpr std::size_t least_samples = 200;
constexpr std::size_t most_samples = 20'000;  // maximum number of samples; they determine the gain to about 2 %
constexpr double median_chi2 = 0.4549;        // median of chi2 with one degree of freedom
constexpr int alternations = 20;
// minimum variance of the shot noise that is considered, relative to the remaining variance
constexpr double least_excess = 0.5;
constexpr double significance = 4;     // smallest significant excess of the variance, in standard errors of the median
constexpr double median_error = 2.33;  // standard error of the median of n values of chi2, times sqrt(n) / median

/// Returns the median of the squared residuals of all samples, each divided by variance(sample).
template <class Variance>
double median_ratio(std::span<ResidualSample const> samples, Variance const& variance) {
  std::vector<double> ratio;
  for (ResidualSample const& one : samples) ratio.push_back(one.square / variance(one));
  return upper_median(std::move(ratio));
}

/// Returns the smallest x >= 0 at which the squared residuals divided by variance(x, sample) have at most the median of
/// chi2. The variance must increase with x.
template <class Variance>
double match_median(std::span<ResidualSample const> samples, Variance const& variance) {
  auto const exceeds = [&](double x) {
    return median_ratio(samples, [&](ResidualSample const& one) { return variance(x, one); }) > median_chi2;
  };
  if (!exceeds(0)) return 0;
  double low = 0, high = 1e-6;
  while (high < 1e12 && exceeds(high)) {
    low = high;
    high *= 4;
  }
  for (int i = 0; i < 20; ++i) {
    double const middle = 0.5 * (low + high);
    (exceeds(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double estimate_conversion_gain(std::vector<ResidualSample> const& samples, double background_noise) {
  std::vector<ResidualSample> lit;
  for (ResidualSample const& one : samples)
    if (one.light > background_noise && one.flux > 0 && std::isfinite(one.square)) lit.push_back(one);
  if (lit.size() < least_samples) return 0;
  std::size_t const stride = (lit.size() + most_samples - 1) / most_samples;
  for (std::size_t i = 0; i * stride < lit.size(); ++i) lit[i] = lit[i * stride];
  lit.resize((lit.size() + stride - 1) / stride);
  auto const share = [](ResidualSample const& one) { return one.light / (one.flux * one.flux); };
  std::sort(lit.begin(), lit.end(),
            [&](ResidualSample const& a, ResidualSample const& b) { return share(a) < share(b); });
  std::span<ResidualSample const> const all(lit);
  auto const deviating = all.first(all.size() / 2), noisy = all.subspan(all.size() / 2);
  double const background = background_noise * background_noise;
  auto const variance = [background](double g, double m2, ResidualSample const& one) {
    return background + g * one.light + m2 * one.flux * one.flux;
  };
  double const least = std::max(least_excess, significance * median_error / std::sqrt(1.0 * noisy.size()));
  double gain = 0, mismatch2 = 0;
  for (int i = 0; i < alternations; ++i) {
    double const before = gain;
    mismatch2 = match_median(deviating, [&](double x, ResidualSample const& one) { return variance(gain, x, one); });
    auto const without_gain = [&](ResidualSample const& one) { return variance(0, mismatch2, one); };
    if (i == 0 && !(median_ratio(noisy, without_gain) > (1 + least) * median_chi2)) return 0;
    gain = match_median(noisy, [&](double x, ResidualSample const& one) { return variance(x, mismatch2, one); });
    if (std::abs(gain - before) <= 1e-3 * gain) break;
  }
  return gain;
}

}  // namespace gladstone::inline tracking
