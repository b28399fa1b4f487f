#include "analysis/density/aperture_deconvolution.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/density/harmonic_continuation.h"
#include "render/base/contracts.h"
#include "render/base/error.h"
#include "render/base/units.h"

namespace gladstone::inline density {
namespace {

/// Returns the matrix of the orthonormal cosine transform (DCT-II) of n values: row k contains the wave of k half
/// periods.
Eigen::MatrixXd make_cosine_transform(int n) {
  Eigen::MatrixXd transform(n, n);
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < n; ++i)
      transform(k, i) = std::sqrt((k == 0 ? 1.0 : 2.0) / n) * std::cos(pi * k * (i + 0.5) / n);
  return transform;
}

void check_deconvolution(ApertureCone const& cone, double maximum_gain) {
  std::vector<SetupProblem> problems;
  if (!(maximum_gain > 1.0) || !std::isfinite(maximum_gain))
    problems.push_back({"maximum_gain", fmt::format("expected a number above 1, got {}", maximum_gain)});
  for (auto const& [name, value] : {std::pair{"pupil_diameter", cone.pupil_diameter},
                                    {"lens_distance", cone.lens_distance},
                                    {"target_distance", cone.target_distance}})
    if (!(value > 0.0) || !std::isfinite(value))
      problems.push_back({name, fmt::format("expected a positive number, got {}", value)});
  if (!(cone.thickness >= 0.0 && cone.thickness <= 2.0 * cone.target_distance))
    problems.push_back({"thickness", fmt::format("expected 0 to twice the target distance, got {}", cone.thickness)});
  if (!problems.empty()) throw SetupError(problems);
}

}  // namespace

struct ApertureDeconvolution::Filter {
  Filter(PlaneGrid const& nodes, std::span<std::uint8_t const> with_density)
      : grid(nodes),
        determined(with_density.begin(), with_density.end()),
        continuation(nodes, with_density),
        along_x(make_cosine_transform(nodes.columns)),
        along_y(make_cosine_transform(nodes.rows)),
        gain(nodes.columns, nodes.rows) {}

  PlaneGrid grid;
  std::vector<std::uint8_t> determined;
  HarmonicContinuation continuation;
  Eigen::MatrixXd along_x, along_y;  ///< matrices of the cosine transforms along each axis
  Eigen::MatrixXd gain;              ///< Wiener gain of every wave [columns, rows]
  double wiener_parameter = 0.0;
};

ApertureDeconvolution::ApertureDeconvolution(PlaneGrid const& grid, std::span<std::uint8_t const> determined,
                                             ApertureCone const& cone, double maximum_gain) {
  GLADSTONE_EXPECTS(determined.size() == grid.size());
  check_deconvolution(cone, maximum_gain);
  if (std::none_of(determined.begin(), determined.end(), [](std::uint8_t d) { return d != 0; }))
    throw DataError(
        ErrorCode::undetermined, "density",
        "no node has a density (there is nothing to deconvolve); check the mask and the validation of the vectors");

  auto filter = std::make_unique<Filter>(grid, determined);
  double const root = maximum_gain - std::sqrt(maximum_gain * maximum_gain - 1.0);
  double const nu = root * root;  // (1 + nu)/(2 sqrt(nu)) = maximum_gain
  filter->wiener_parameter = nu;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      double const wavenumber =
          std::hypot(0.5 * column / (grid.columns * grid.spacing.x), 0.5 * row / (grid.rows * grid.spacing.y));
      double const h = compute_aperture_transfer(cone, wavenumber);
      filter->gain(column, row) = h * (1.0 + nu) / (h * h + nu);
    }
  filter_ = std::move(filter);
}

ApertureDeconvolution::~ApertureDeconvolution() = default;
ApertureDeconvolution::ApertureDeconvolution(ApertureDeconvolution&&) noexcept = default;
ApertureDeconvolution& ApertureDeconvolution::operator=(ApertureDeconvolution&&) noexcept = default;

double ApertureDeconvolution::wiener_parameter() const { return filter_->wiener_parameter; }

double ApertureDeconvolution::white_noise_gain() const {
  return std::sqrt(filter_->gain.squaredNorm() / static_cast<double>(filter_->gain.size()));
}

std::vector<double> ApertureDeconvolution::apply(std::span<double const> density) const {
  Filter const& f = *filter_;
  GLADSTONE_EXPECTS(density.size() == f.grid.size());
  Eigen::VectorXd const filled = f.continuation.fill(density);
  Eigen::Map<Eigen::MatrixXd const> const values(filled.data(), f.grid.columns, f.grid.rows);
  Eigen::MatrixXd waves = f.along_x * values * f.along_y.transpose();
  waves.array() *= f.gain.array();
  Eigen::MatrixXd const result = f.along_x.transpose() * waves * f.along_y;
  std::vector<double> deconvolved(density.size());
  for (std::size_t i = 0; i < density.size(); ++i)
    deconvolved[i] = f.determined[i] != 0 ? result.data()[i] : (std::isnan(density[i]) ? density[i] : 0.0);
  return deconvolved;
}

}  // namespace gladstone::inline density
