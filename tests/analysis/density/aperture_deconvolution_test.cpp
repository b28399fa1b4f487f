#include "analysis/density/aperture_deconvolution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "analysis/density/density_uncertainty.h"
#include "render/base/error.h"
#include "tests/analysis/density/density_cases.h"
#include "tests/support/expect_error.h"

namespace gladstone::inline density {
namespace {

/// Table 1 of Rajendran, Bane & Vlachos: 105 mm at f/11, D_c = 2.386 mm.
ApertureCone table_1_cone(double thickness = 0.01) { return {0.105 / 11.0, 0.75, 0.25, thickness}; }

/// Grid of 60 x 50 nodes, 0.5 mm apart, around the origin.
PlaneGrid half_millimetre_grid() { return {60, 50, {-0.01475, -0.01225}, {0.5e-3, 0.5e-3}}; }

double gaussian(Vec2d p) { return std::exp(-(p.x * p.x + p.y * p.y) / (2e-3 * 2e-3)); }

/// Mean of the Gaussian over discs of the diameters in the medium, weighted with the lever, by brute force in space.
double cone_average(Vec2d p, ApertureCone const& cone) {
  double sum = 0.0, weights = 0.0;
  for (int slice = 0; slice < 4; ++slice) {
    double const s = cone.target_distance + cone.thickness * ((slice + 0.5) / 4 - 0.5);
    double const radius = 0.5 * cone.pupil_diameter * s / (cone.lens_distance + cone.target_distance);
    for (int i = 0; i < 24; ++i)
      for (int j = 0; j < 24; ++j) {  // rings of equal area
        double const r = radius * std::sqrt((i + 0.5) / 24), angle = 2.0 * pi * (j + 0.5 * (i % 2)) / 24;
        sum += s * gaussian({p.x + r * std::cos(angle), p.y + r * std::sin(angle)});
        weights += s;
      }
  }
  return sum / weights;
}

// Set-up of Table 1, formula by quadrature: 0.620565 at a wavelength of 4 mm, 0.894131 at 8 mm. For a thin medium -3 dB
// at D_c/wavelength = 0.51450 (F10 in docs/design.md), and the first zero at 1.21967.
TEST(ApertureTransfer, AgreesWithTheFormulaAtTable1) {
  EXPECT_NEAR(compute_aperture_transfer(table_1_cone(), 1.0 / 4e-3), 0.620565, 2e-6);
  EXPECT_NEAR(compute_aperture_transfer(table_1_cone(), 1.0 / 8e-3), 0.894131, 2e-6);
  EXPECT_EQ(compute_aperture_transfer(table_1_cone(), 0.0), 1.0);
  ApertureCone const thin = table_1_cone(0.0);
  EXPECT_NEAR(compute_aperture_transfer(thin, 1.21967 / thin.diameter()), 0.0, 2e-6);
  EXPECT_NEAR(compute_aperture_transfer(thin, 0.51450 / thin.diameter()), std::sqrt(0.5), 2e-5);
}

// The averaging over a cone of 2.386 mm lowers the peak of a Gaussian of 2 mm by 15 %. The deconvolution restores it
// except for waves beyond the first zero and for the limit of the gain.
TEST(ApertureDeconvolution, RestoresAnAveragedGaussian) {
  PlaneGrid const grid = half_millimetre_grid();
  std::vector<double> averaged;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      averaged.push_back(cone_average(grid.position(column, row), table_1_cone()));
  std::vector<std::uint8_t> const all(grid.size(), 1);
  ApertureDeconvolution const deconvolution(grid, all, table_1_cone(), 20.0);
  FieldError const before = compare_with(grid, averaged, gaussian);
  FieldError const after = compare_with(grid, deconvolution.apply(averaged), gaussian);
  EXPECT_GT(before.largest, 0.1);
  EXPECT_LT(after.largest, 0.1 * before.largest);
  EXPECT_LT(after.rms, 0.1 * before.rms);

  // A hole away from the Gaussian hardly matters; its nodes stay NaN
  std::vector<std::uint8_t> determined = all;
  for (int row = 5; row < 9; ++row)
    for (int column = 5; column < 9; ++column) {
      determined[grid.index(column, row)] = 0;
      averaged[grid.index(column, row)] = std::nan("");
    }
  std::vector<double> const result = ApertureDeconvolution(grid, determined, table_1_cone(), 20.0).apply(averaged);
  EXPECT_TRUE(std::isnan(result[grid.index(6, 6)]));
  EXPECT_LT(compare_with(grid, result, gaussian).largest, 0.1 * before.largest);
}

// Constants pass unchanged, no wave gains more than the limit, and (1 + nu)/(2 sqrt(nu)) is that limit.
TEST(ApertureDeconvolution, HasTheGivenGain) {
  PlaneGrid const grid = half_millimetre_grid();
  std::vector<std::uint8_t> const all(grid.size(), 1);
  ApertureDeconvolution const deconvolution(grid, all, table_1_cone(), 3.0);
  double const nu = deconvolution.wiener_parameter();
  EXPECT_NEAR((1.0 + nu) / (2.0 * std::sqrt(nu)), 3.0, 1e-12);
  for (double value : deconvolution.apply(std::vector<double>(grid.size(), 1.3))) EXPECT_NEAR(value, 1.3, 1e-12);
  double largest = 0.0;
  for (int k = 1; k < 60; ++k) {
    std::vector<double> wave;
    for (std::size_t i = 0; i < grid.size(); ++i)
      wave.push_back(std::cos(pi * k * (static_cast<double>(i % 60) + 0.5) / 60.0));
    largest = std::max(largest, std::abs(deconvolution.apply(wave)[0] / wave[0]));
  }
  EXPECT_LE(largest, 3.0 + 1e-9);
  EXPECT_GT(largest, 2.8);
}

// Sigma of the deconvolved density is that of errors after the same filter. The deconvolution enlarges it, but by less
// than it amplifies white noise.
TEST(ApertureDeconvolution, AmplifiesTheUncertainty) {
  GradientMap map;
  map.grid = {30, 25, {}, {0.5e-3, 0.5e-3}};
  map.valid.assign(map.grid.size(), 1);
  map.gradient.assign(map.grid.size(), {});
  map.sigma.assign(map.grid.size(), {2.0, 2.0});
  DensityIntegrator const integrator(map, make_side_reference(map.grid, GridSide::left, 0.0));
  ApertureDeconvolution const deconvolution(map.grid, integrator.determined(), table_1_cone(), 5.0);
  DensityFilter const filter = [&](std::span<double const> error) { return deconvolution.apply(error); };
  DensityUncertainty const before = propagate_uncertainty(integrator, map.sigma, {2.0, 2.0});
  DensityUncertainty const after = propagate_uncertainty(integrator, map.sigma, {2.0, 2.0}, 0.0, {}, filter);
  EXPECT_EQ(after.samples, 400u);
  std::size_t const node = map.grid.index(15, 12);
  EXPECT_GT(after.sigma[node], 1.05 * before.sigma[node]);
  EXPECT_LT(after.sigma[node], deconvolution.white_noise_gain() * before.sigma[node]);
}

TEST(ApertureDeconvolution, RejectsBadInput) {
  PlaneGrid const grid = half_millimetre_grid();
  std::vector<std::uint8_t> const all(grid.size(), 1), none(grid.size(), 0);
  EXPECT_THROW(ApertureDeconvolution(grid, all, table_1_cone(), 1.0), SetupError);
  EXPECT_THROW(ApertureDeconvolution(grid, all, table_1_cone(), std::nan("")), SetupError);
  EXPECT_THROW(ApertureDeconvolution(grid, all, {}, 2.0), SetupError);
  EXPECT_THROW(ApertureDeconvolution(grid, all, table_1_cone(1.0), 2.0), SetupError);
  EXPECT_THAT([&] { ApertureDeconvolution(grid, none, table_1_cone(), 2.0); },
              ThrowsDataError(ErrorCode::undetermined, "density"));
}

}  // namespace
}  // namespace gladstone::inline density
