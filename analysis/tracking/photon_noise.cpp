#include "analysis/tracking/photon_noise.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "render/base/median.h"

namespace gladstone::tracking {
namespace {

constexpr std::size_t least_samples = 200;
constexpr std::size_t most_samples = 20'000;  // determine the gain to about 2 %
constexpr double median_chi2 = 0.4549;        // of one degree of freedom
constexpr int alternations = 20;

/// Returns the smallest x >= 0 for which the median of square / variance(x, light) is at most that of chi2. The
/// variance increases with x.
template <class Variance>
double match_median(std::span<ResidualSample const> samples, Variance const& variance) {
  auto const exceeds = [&](double x) {
    std::vector<double> ratio;
    for (ResidualSample const& one : samples) ratio.push_back(one.square / variance(x, one.light));
    return upper_median(std::move(ratio)) > median_chi2;
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
    if (one.light > background_noise && std::isfinite(one.square)) lit.push_back(one);
  if (lit.size() < least_samples) return 0;
  std::size_t const stride = (lit.size() + most_samples - 1) / most_samples;
  for (std::size_t i = 0; i * stride < lit.size(); ++i) lit[i] = lit[i * stride];
  lit.resize((lit.size() + stride - 1) / stride);
  std::sort(lit.begin(), lit.end(), [](ResidualSample const& a, ResidualSample const& b) { return a.light < b.light; });
  std::span<ResidualSample const> const all(lit);
  auto const faint = all.first(all.size() / 2), bright = all.subspan(all.size() / 2);
  double const background = background_noise * background_noise;
  double gain = 0, mismatch2 = 0;
  for (int i = 0; i < alternations; ++i) {
    double const before = gain;
    mismatch2 = match_median(bright, [&](double x, double light) { return background + (gain + x * light) * light; });
    gain = match_median(faint, [&](double x, double light) { return background + (x + mismatch2 * light) * light; });
    if (std::abs(gain - before) <= 1e-3 * gain) break;
  }
  return gain;
}

}  // namespace gladstone::tracking
