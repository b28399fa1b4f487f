#include <cmath>

#include "analysis/uncertainty/uncertainty.h"

namespace gladstone::inline uncertainty {
namespace {

// Fitted to the errors of the default passes for dots of 3 px at 5 % noise; docs/estimators.md reports how well it
// applies to other images.
constexpr double slope_px = 0.23;
constexpr double power = 1.0;
constexpr double least_px = 0.003;

}  // namespace

std::vector<Vec2d> peak_ratio_uncertainty(UncertaintyInput const& input) {
  std::vector<Vec2d> sigma;
  sigma.reserve(input.field.size());
  for (double const ratio : input.field.peak_ratio) {
    double const falling = slope_px * std::pow(ratio, -power);
    double const value = std::sqrt(falling * falling + least_px * least_px);
    sigma.push_back({value, value});
  }
  return sigma;
}

}  // namespace gladstone::inline uncertainty
