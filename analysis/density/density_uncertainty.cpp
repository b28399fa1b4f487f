#include "analysis/density/density_uncertainty.h"

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/base/random_variates.h"

namespace gladstone::inline density {
namespace {

/// Number of samples in one partial sum; a fixed number makes the total independent of the number of threads.
constexpr std::size_t samples_per_sum = 16;

double square_sum(std::span<double const> values) {
  double sum = 0.0;
  for (double v : values) sum += v * v;
  return sum;
}

/// Computes the variance of the density at one node: the sum over both gradient components of z^T r z, where z
/// is the sensitivity times sigma, and r the correlation of the vectors.
double compute_node_variance(DensityIntegrator const& integrator, WindowCorrelation const& correlation,
                             std::span<Vec2d const> sigma, std::size_t node) {
  std::vector<Vec2d> const sensitivity = integrator.compute_sensitivity(node);
  std::vector<double> x(sigma.size()), y(sigma.size());
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    if (sensitivity[i].x != 0.0) x[i] = sensitivity[i].x * sigma[i].x;
    if (sensitivity[i].y != 0.0) y[i] = sensitivity[i].y * sigma[i].y;
  }
  return square_sum(correlation.correlate_transposed(x)) + square_sum(correlation.correlate_transposed(y));
}

/// Estimates the variance of the density at every node by the mean square of its error over random samples.
std::vector<double> estimate_variances(DensityIntegrator const& integrator, WindowCorrelation const& correlation,
                                       std::span<Vec2d const> sigma, PropagationSettings const& settings,
                                       DensityFilter const& filter) {
  std::size_t const sums = (settings.samples + samples_per_sum - 1) / samples_per_sum;
  std::vector<std::vector<double>> partial(sums);
  parallel_for(sums, [&](std::size_t s) {
    std::vector<double>& sum = partial[s];
    sum.assign(sigma.size(), 0.0);
    for (std::size_t k = s * samples_per_sum; k < std::min(settings.samples, (s + 1) * samples_per_sum); ++k) {
      std::vector<double> error = integrator.integrate_error(draw_gradient_error(correlation, sigma, settings.seed, k));
      if (filter) error = filter(error);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += error[i] * error[i];
    }
  });
  std::vector<double> variance(sigma.size());
  for (std::vector<double> const& sum : partial)
    for (std::size_t i = 0; i < variance.size(); ++i) variance[i] += sum[i] / static_cast<double>(settings.samples);
  return variance;
}

}  // namespace

std::vector<Vec2d> draw_gradient_error(WindowCorrelation const& correlation, std::span<Vec2d const> sigma,
                                       std::uint64_t seed, std::uint64_t sample) {
  KeyedEngine engine(seed, RandomStream::noise_flow, sample);
  std::vector<double> x(sigma.size()), y(sigma.size());
  for (double& value : x) value = normal_variate(engine);
  for (double& value : y) value = normal_variate(engine);
  x = correlation.correlate(x);
  y = correlation.correlate(y);
  std::vector<Vec2d> error(sigma.size());
  for (std::size_t i = 0; i < sigma.size(); ++i) error[i] = {x[i] * sigma[i].x, y[i] * sigma[i].y};
  return error;
}

DensityUncertainty propagate_uncertainty(DensityIntegrator const& integrator, std::span<Vec2d const> sigma,
                                         WindowOverlap overlap, double reference_sigma,
                                         PropagationSettings const& settings, DensityFilter const& filter) {
  std::size_t const size = integrator.grid().size();
  if (sigma.empty())
    throw DataError(ErrorCode::missing_content, "density gradient",
                    "the vectors have no uncertainty (that of the density cannot be computed); correlate with an "
                    "uncertainty method, or give sigma for every vector");
  GLADSTONE_EXPECTS(sigma.size() == size);
  if (settings.samples == 0) throw SetupError({SetupProblem{"samples", "expected at least 1 sample, got 0"}});
  WindowCorrelation const correlation(integrator.grid().columns, integrator.grid().rows, overlap);

  DensityUncertainty result;
  std::vector<double> variance;
  if (integrator.unknowns() <= settings.exact_limit && !filter) {
    variance.resize(size);
    parallel_for(size, [&](std::size_t i) {
      if (integrator.determined()[i] != 0 && integrator.reference_nodes()[i] == 0)
        variance[i] = compute_node_variance(integrator, correlation, sigma, i);
    });
  } else {
    variance = estimate_variances(integrator, correlation, sigma, settings, filter);
    result.samples = settings.samples;
    result.relative_error = 1.0 / std::sqrt(2.0 * static_cast<double>(settings.samples));
  }
  result.sigma.assign(size, not_a_number);
  for (std::size_t i = 0; i < size; ++i)
    if (integrator.determined()[i] != 0) result.sigma[i] = std::sqrt(variance[i] + reference_sigma * reference_sigma);
  return result;
}

std::vector<double> add_scale_uncertainty(std::vector<double> sigma, std::span<double const> density, double reference,
                                          double relative) {
  GLADSTONE_EXPECTS(sigma.size() == density.size());
  for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i] = std::hypot(sigma[i], relative * (density[i] - reference));
  return sigma;
}

}  // namespace gladstone::inline density
