#include "analysis/vectors/convention_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/base/not_a_number.h"

namespace gladstone::inline vectors {
bool same_axes(VectorConventions const& a, VectorConventions const& b) {
  return a.y_up == b.y_up && a.v_up == b.v_up && a.swapped == b.swapped && a.exchange == b.exchange;
}

DisplacementField sample(DisplacementField const& field, std::size_t most) {
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (field.counts(i) && is_finite(field.displacement_px[i])) usable.push_back(i);
  }
  std::size_t const stride = std::max<std::size_t>(1, (usable.size() + most - 1) / most);
  DisplacementField few;
  auto const take = [&](std::size_t i, VectorStatus status) {
    few.position_px.push_back(field.position_px[i]);
    few.displacement_px.push_back(field.displacement_px[i]);
    few.status.push_back(status);
  };
  for (std::size_t k = 0; k < usable.size(); k += stride) take(usable[k], VectorStatus::valid);
  auto const by_y = [&](std::size_t a, std::size_t b) { return field.position_px[a].y < field.position_px[b].y; };
  std::vector<std::size_t> all(field.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  if (!all.empty()) {
    auto const [low, high] = std::minmax_element(all.begin(), all.end(), by_y);
    take(*low, VectorStatus::masked);  // added as masked vectors, which determine the extent of the grid only
    take(*high, VectorStatus::masked);
  }
  return few;
}

double robust_spread(std::vector<double> const& errors) {
  constexpr double least = 1e-4;
  constexpr double of_normal =
      0.459937802416;  // mean of log(m) + log(1 + (z / m)^2), z standard normal, m = median |z|
  if (errors.empty()) return not_a_number;
  std::vector<double> sizes(errors.size());
  std::transform(errors.begin(), errors.end(), sizes.begin(), [](double e) { return std::abs(e); });
  auto const middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  double const median = std::max(*middle, least);
  double sum = 0.0;
  for (double const size : sizes) sum += std::log1p(size * size / (median * median));
  return median * std::exp(sum / static_cast<double>(sizes.size()) - of_normal);
}

ConventionFit fit_within(DisplacementField const& field, VectorConventions const& conventions, Truth const& truth,
                         int image_rows, double most) {
  DisplacementField const ours = apply_conventions(field, conventions, image_rows);
  double differences = 0.0, signal = 0.0, product = 0.0;
  std::size_t count = 0, known = 0;
  // one list per component, since only one of the components may be biased
  std::array<std::vector<double>, 2> errors, truths;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!ours.counts(i)) continue;
    Vec2d const t = truth(ours.position_px[i]);
    count += 2;
    if (!is_finite(t)) {
      differences += 2 * most * most;
      for (std::vector<double>& component : errors) component.push_back(most);
      continue;
    }
    known += 2;
    for (std::size_t k = 0; k < 2; ++k) {
      double Vec2d::*const component = k == 0 ? &Vec2d::x : &Vec2d::y;
      double const e = std::clamp(ours.displacement_px[i].*component - t.*component, -most, most);
      errors[k].push_back(e);
      truths[k].push_back(t.*component);
      differences += e * e;
      signal += t.*component * t.*component;
      product += (t.*component + e) * t.*component;
    }
  }
  ConventionFit fit;
  fit.conventions = conventions;
  fit.rms_px = fit.signal_px = fit.slope = fit.slope_error = not_a_number;
  fit.components = count;
  auto const of_both = [](auto const& components) {
    return std::sqrt(0.5) * std::hypot(robust_spread(components[0]), robust_spread(components[1]));
  };
  fit.spread_px = of_both(errors);
  fit.signal_spread_px = of_both(truths);
  if (count > 0) fit.rms_px = std::sqrt(differences / static_cast<double>(count));
  if (known > 0) fit.signal_px = std::sqrt(signal / static_cast<double>(known));
  if (signal > 0.0) {
    fit.slope = product / signal;
    // At an overlap of one half, every vector shares its image with three other vectors, which doubles the standard
    // error.
    fit.slope_error = 2.0 * fit.rms_px / std::sqrt(signal);
  }
  return fit;
}

double largest_difference(DisplacementField const& field, VectorConventions const& conventions, Truth const& truth,
                          int image_rows) {
  double const signal = fit_within(field, conventions, truth, image_rows, 1.0).signal_px;
  return std::isfinite(signal) ? std::max(1.0, 3.0 * signal) : 1.0;
}

double convention_penalty(VectorConventions const& reading, std::vector<VectorConventions> const& own) {
  double least = std::numeric_limits<double>::infinity();
  for (VectorConventions const& one : own) least = std::min(least, convention_penalty(reading, one));
  return least;
}

double convention_penalty(VectorConventions const& reading, VectorConventions const& own) {
  bool const y = reading.y_up != own.y_up, v = reading.v_up != own.v_up;
  return (y && v ? 1.1 : (y ? 1.0 : 0.0) + (v ? 1.0 : 0.0)) + (reading.swapped != own.swapped ? 1.0 : 0.0) +
         (reading.exchange != own.exchange ? 1.2 : 0.0) + (reading.offset_px != own.offset_px ? 0.3 : 0.0) +
         (reading.y_up && own.y_up && reading.mirror != own.mirror ? 0.2 : 0.0);
}

double log_likelihood_statistic(ConventionFit const& a, ConventionFit const& b) {
  constexpr double alike_px = 1e-4;
  double const independent = 0.25 * static_cast<double>(std::min(a.components, b.components));
  return independent * 2.0 * std::log(std::max(b.spread_px, alike_px) / std::max(a.spread_px, alike_px));
}

}  // namespace gladstone::inline vectors
