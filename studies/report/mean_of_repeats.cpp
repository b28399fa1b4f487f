#include "studies/report/mean_of_repeats.h"

#include <cmath>

#include "analysis/errors/error_summary.h"

namespace gladstone::inline report {

MeanOfRepeats mean_of_repeats(std::vector<DisplacementField> const& all, double formula_px) {
  MeanOfRepeats mean;
  mean.field = all.front();
  mean.count = all.size();
  if (mean.count == 1) return mean;
  DisplacementField& field = mean.field;
  auto const n = static_cast<double>(mean.count);
  std::vector<double> estimated;
  field.sigma_px.assign(field.size(), {std::nan(""), std::nan("")});
  field.status.resize(field.size(), VectorStatus::valid);
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d sum, squares, variance;
    bool counts = true;
    for (DisplacementField const& one : all) {
      Vec2d const d = one.displacement_px[i];
      counts = counts && one.counts(i) && is_finite(d);
      sum += d;
      Vec2d own = one.sigma_px.empty() ? Vec2d{formula_px, formula_px} : one.sigma_px[i];
      if (!std::isfinite(own.x) || !std::isfinite(own.y)) own = {formula_px, formula_px};
      variance += {own.x * own.x, own.y * own.y};
    }
    if (!counts) {
      field.status[i] = VectorStatus::invalid;
      continue;
    }
    field.displacement_px[i] = sum / n;
    for (DisplacementField const& one : all) {
      Vec2d const off = one.displacement_px[i] - field.displacement_px[i];
      squares += {off.x * off.x, off.y * off.y};
    }
    field.sigma_px[i] = {std::sqrt(squares.x / (n - 1) / n), std::sqrt(squares.y / (n - 1) / n)};
    estimated.push_back(std::sqrt(variance.x) / n);
    estimated.push_back(std::sqrt(variance.y) / n);
  }
  mean.estimated_px = estimated.empty() ? std::nan("") : quantile(estimated, 0.5);
  return mean;
}

}  // namespace gladstone::inline report
