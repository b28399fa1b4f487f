#include "analysis/density/axisymmetric_inversion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "analysis/density/abel_operators.h"
#include "render/base/error.h"
#include "tests/analysis/density/density_cases.h"
#include "tests/support/expect_error.h"

namespace gladstone::inline density {
namespace {

/// exp(-r^2/s^2) at n radii from 0 to 4 s, its projection sqrt(pi) s exp(-x^2/s^2) and the derivative of that. An Abel
/// pair.
struct GaussianPair {
  explicit GaussianPair(int n) : density(n), projection(n), gradient(n), spacing(4.0 / (n - 1)) {
    for (int i = 0; i < n; ++i) {
      double const r = i * spacing;  // s = 1
      density[i] = std::exp(-r * r);
      projection[i] = std::sqrt(pi) * density[i];
      gradient[i] = -2.0 * r * projection[i];
    }
  }
  Eigen::VectorXd density, projection, gradient;
  double spacing;
  double rms(Eigen::VectorXd const& result) const {
    return std::sqrt((result - density).squaredNorm() / static_cast<double>(density.size()));
  }
};

/// Vertical jet of radius 0.15 along x = 0.47 whose excess density -0.4 decays upwards; projected gradient on n x rows
/// nodes of the unit width.
double jet_density(double r, double z) { return -0.4 * (1.0 - 0.5 * z) * std::exp(-r * r / (0.15 * 0.15)); }
GradientMap jet_map(int n, int rows, double axis = 0.47) {
  GradientMap map;
  map.grid = {n, rows, {0.0, 0.0}, {1.0 / (n - 1), 0.02}};
  map.valid.assign(map.grid.size(), 1);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < n; ++column) {
      Vec2d const p = map.grid.position(column, row);
      double const x = p.x - axis, projection = std::sqrt(pi) * 0.15 * jet_density(x, p.y);
      map.gradient.push_back({-2.0 * x / (0.15 * 0.15) * projection, 0.0});
      map.sigma.push_back({0.02, 0.02});
    }
  return map;
}

double jet_error(AxisymmetricDensity const& result, double ambient) {
  double largest = 0.0;
  for (int row = 0; row < result.grid.rows; ++row)
    for (int i = 0; i < result.grid.columns; ++i) {
      Vec2d const p = result.grid.position(i, row);
      double const error = result.density[result.grid.index(i, row)] - ambient - jet_density(p.x, p.y);
      if (std::isfinite(error)) largest = std::max(largest, std::abs(error));
    }
  return largest;
}

// The inversion of the gradient is of order 4: 1.5e-6 with 71 radii, 1.0e-7 with 141; then the gradient that is cut off
// at 4 s remains, 2.4e-8. docs/peers/peer_abel.py compares PyAbel on the same grid.
TEST(AbelOperators, GradientInversionIsOfOrderFour) {
  GaussianPair const coarse(71), middle(141), finest(513);
  double const e71 = coarse.rms(make_gradient_inversion(71) * coarse.gradient);
  double const e141 = middle.rms(make_gradient_inversion(141) * middle.gradient);
  double const e513 = finest.rms(make_gradient_inversion(513) * finest.gradient);
  EXPECT_LE(e141, 1.5e-7);
  EXPECT_LE(e513, 5e-8);
  EXPECT_GT(std::log2(e71 / e141), 3.5);
}

// The projected gradient of the Gaussian is that of the Abel pair.
TEST(AbelOperators, ProjectsAGaussian) {
  GaussianPair const coarse(71), fine(141);
  double const a = (make_gradient_projection(71) * coarse.density - coarse.gradient).norm() / coarse.gradient.norm();
  double const b = (make_gradient_projection(141) * fine.density - fine.gradient).norm() / fine.gradient.norm();
  EXPECT_LT(b, 1e-4);
  EXPECT_GT(std::log2(a / b), 2.0);
}

// Cubic interpolation of the gradient, 12 nodes to the jet's radius, finds the axis to a few thousandths of a node.
TEST(SymmetryAxis, IsFoundBetweenNodes) {
  for (double axis : {0.47, 0.5, 0.512345}) {
    GradientMap const map = jet_map(81, 5, axis);
    EXPECT_NEAR(find_symmetry_axis(map, AxisDirection::vertical).position, axis, 3e-3 * map.grid.spacing.x);
    EXPECT_NEAR(find_symmetry_axis(transpose_map(map), AxisDirection::horizontal).position, axis,
                3e-3 * map.grid.spacing.x);
  }
}

// The stated sigma is that of positions found in noisy fields.
TEST(SymmetryAxis, StatesItsUncertainty) {
  GradientMap const clean = jet_map(61, 8);
  WindowCorrelation const correlation(61, 8, {2.0, 2.0});
  double const sigma = find_symmetry_axis(clean, AxisDirection::vertical, {2.0, 2.0}).sigma;
  double square = 0.0;
  int const seeds = 100;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    GradientMap const noisy = with_noise(clean, correlation, seed);
    double const error = find_symmetry_axis(noisy, AxisDirection::vertical).position - 0.47;
    square += error * error / seeds;
  }
  EXPECT_NEAR(std::sqrt(square) / sigma, 1.0, 0.35);
}

// The inversion of a clean jet, with its axis determined, reproduces the density. Where vectors are missing on both
// sides of the axis, the smaller radii of that row are undetermined; where they are missing on one side, nothing is
// lost.
TEST(AxisymmetricInversion, ReconstructsAJet) {
  AxisymmetricSettings settings;
  settings.ambient_density = 1.2;
  GradientMap const map = jet_map(101, 6);
  AxisymmetricDensity const result = invert_axisymmetric(map, settings);
  EXPECT_LT(jet_error(result, 1.2), 5e-4);
  EXPECT_LT(result.asymmetry, 1e-3);
  EXPECT_LT(result.border_gradient, 1e-3);

  settings.direction = AxisDirection::horizontal;
  AxisymmetricDensity const turned = invert_axisymmetric(transpose_map(map), settings);
  for (std::size_t i = 0; i < result.density.size(); ++i) EXPECT_NEAR(turned.density[i], result.density[i], 1e-9);

  settings.direction = AxisDirection::vertical;
  settings.axis = 0.47;
  GradientMap holes = map;
  for (int column : {60, 61, 62}) holes.valid[map.grid.index(column, 2)] = 0;
  AxisymmetricDensity const one_sided = invert_axisymmetric(holes, settings);
  EXPECT_EQ(one_sided.grid.columns, 54);  // 0.53 to the right of the axis at a spacing of 0.01
  EXPECT_LT(jet_error(one_sided, 1.2), 5e-4);
  EXPECT_TRUE(std::isfinite(one_sided.density[one_sided.grid.index(0, 2)]));
  for (int column : {31, 32, 33, 34}) holes.valid[map.grid.index(column, 2)] = 0;
  AxisymmetricDensity const holed = invert_axisymmetric(holes, settings);
  EXPECT_TRUE(std::isnan(holed.density[holed.grid.index(3, 2)]));
  EXPECT_TRUE(std::isfinite(holed.density[holed.grid.index(30, 2)]));
  EXPECT_TRUE(std::isfinite(holed.density[holed.grid.index(3, 3)]));
}

// Sigma is that of the errors, for both methods, and the regularised inversion has less noise on the axis. Lambda is
// fixed, so that the inversion is linear; errors are counted from the inversion of the clean field.
TEST(AxisymmetricInversion, PropagatesTheUncertainty) {
  GradientMap const clean = jet_map(41, 12);
  AxisymmetricSettings settings;
  settings.axis = 0.47;
  settings.overlap = {2.0, 2.0};
  settings.choice = RegularizationChoice::given;
  settings.lambda = 30.0;
  WindowCorrelation const correlation(41, 12, settings.overlap);
  double sigma_on_axis[2] = {};
  for (std::string const method : {"direct", "tikhonov"}) {
    settings.method = method;
    AxisymmetricDensity const expected = invert_axisymmetric(clean, settings);
    double within = 0.0, count = 0.0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      AxisymmetricDensity const result = invert_axisymmetric(with_noise(clean, correlation, seed), settings);
      for (std::size_t i = 0; i < result.density.size(); ++i) {
        if (!(result.sigma[i] > 1e-12)) continue;  // the last radius of the direct method is ambient by definition
        count += 1.0;
        within += std::abs(result.density[i] - expected.density[i]) <= result.sigma[i];
      }
    }
    sigma_on_axis[method == "tikhonov" ? 1 : 0] = expected.sigma[0];
    EXPECT_GT(within / count, 0.60);
    EXPECT_LT(within / count, 0.76);
  }
  EXPECT_LT(sigma_on_axis[1], 0.75 * sigma_on_axis[0]);
}

// The vectors are fine (24 to the jet's radius) and noisy (a quarter of the largest gradient): both rules reduce the
// largest error. The inversion of a gradient is a half integration, so on coarse grids there is little to gain.
TEST(AxisymmetricInversion, ChoosesTheRegularization) {
  GradientMap map = jet_map(161, 4);
  for (Vec2d& sigma : map.sigma) sigma = {0.15, 0.15};
  map = with_noise(map, WindowCorrelation(161, 4, {}), 3);
  AxisymmetricSettings settings;
  settings.axis = 0.47;
  double const direct = jet_error(invert_axisymmetric(map, settings), 0.0);
  settings.method = "tikhonov";
  for (RegularizationChoice choice : {RegularizationChoice::discrepancy, RegularizationChoice::cross_validation}) {
    settings.choice = choice;
    AxisymmetricDensity const result = invert_axisymmetric(map, settings);
    EXPECT_GT(result.lambda, 50.0);
    EXPECT_LT(result.lambda, 5e4);
    EXPECT_LT(jet_error(result, 0.0), 0.7 * direct);
  }
}

TEST(AxisymmetricInversion, RejectsBadInput) {
  GradientMap const map = jet_map(31, 3);
  AxisymmetricSettings outside;
  outside.axis = 1.2;
  EXPECT_THROW(invert_axisymmetric(map, outside), SetupError);
  outside.axis = std::nan("");
  EXPECT_THROW(invert_axisymmetric(map, outside), SetupError);
  AxisymmetricSettings lambda;
  lambda.method = "tikhonov";
  lambda.choice = RegularizationChoice::given;
  EXPECT_THROW(invert_axisymmetric(map, lambda), SetupError);
  lambda.choice = RegularizationChoice::discrepancy;
  GradientMap without_sigma = map;
  without_sigma.sigma.clear();
  EXPECT_THAT([&] { invert_axisymmetric(without_sigma, lambda); },
              ThrowsDataError(ErrorCode::missing_content, "density gradient"));
  AxisymmetricSettings overlap;
  overlap.overlap = {2.0, 100.0};
  EXPECT_THROW(invert_axisymmetric(map, overlap), SetupError);
  GradientMap flat = map;
  flat.gradient.assign(map.grid.size(), {1.0, 0.0});
  EXPECT_THAT([&] { invert_axisymmetric(flat, {}); }, ThrowsDataError(ErrorCode::undetermined, "axis"));  // no axis
}

// The inversion of a row starts at its largest measured radius, beyond which the density is the ambient one. A mask
// over larger radii, where the gradient vanishes (exp(-8) at 0.42 from the axis), therefore changes the density by less
// than the interpolation of the gradient; density is stated where it is measured only.
TEST(AxisymmetricInversion, StartsAtTheLargestMeasuredRadius) {
  GradientMap map = jet_map(101, 4);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 101; ++column)
      if (column > 89 + row) map.valid[map.grid.index(column, row)] = 0;
  AxisymmetricSettings settings;
  for (std::string const method : {"direct", "tikhonov"}) {
    settings.method = method;
    settings.choice = RegularizationChoice::given;
    settings.lambda = 1e-3;
    for (std::optional<double> axis : {std::optional<double>(), std::optional(0.47)}) {
      settings.axis = axis;
      AxisymmetricDensity const result = invert_axisymmetric(map, settings);
      EXPECT_LT(jet_error(result, 0.0), 1.5e-3);
      EXPECT_TRUE(std::isfinite(result.density[result.grid.index(0, 0)]));
    }
    AxisymmetricDensity const result = invert_axisymmetric(map, settings);  // the left side ends at 0.47
    EXPECT_TRUE(std::isfinite(result.density[result.grid.index(47, 0)]));
    EXPECT_TRUE(std::isnan(result.density[result.grid.index(48, 0)]));
  }
}

// One side of the axis determines the density. If the image begins at the axis, or at a distance from it, the axis is
// outside the vectors. Radii smaller than this distance are then not measured, and at the first radius the gradient is
// interpolated between two nodes only (1 % of the density difference of 0.4).
TEST(AxisymmetricInversion, InvertsOneSide) {
  AxisymmetricSettings settings;
  settings.axis_range = {-0.1, 1.1};
  for (double const axis : {0.0, -0.035}) {
    settings.axis = axis;
    GradientMap const map = jet_map(101, 4, axis);
    for (std::string const method : {"direct", "tikhonov"}) {
      settings.method = method;
      settings.choice = RegularizationChoice::given;
      settings.lambda = 1e-3;
      AxisymmetricDensity const result = invert_axisymmetric(map, settings);
      EXPECT_LT(jet_error(result, 0.0), axis == 0.0 ? 1.5e-3 : 4e-3) << axis;
      EXPECT_TRUE(std::isnan(result.asymmetry));
      EXPECT_EQ(std::isfinite(result.density[result.grid.index(3, 0)]), axis == 0.0);
      EXPECT_TRUE(std::isfinite(result.density[result.grid.index(4, 0)]));
    }
    settings.axis.reset();
    settings.method = "direct";
    EXPECT_THROW(invert_axisymmetric(map, settings), DataError) << "an axis between the vectors is not one of symmetry";
  }
}

// About a wrong axis the gradients on both sides have the same sign, or one of them vanishes. Noise alone makes no axis
// wrong: with a third of the largest gradient the flow is still found to be symmetric, and its asymmetry is stated.
TEST(AxisymmetricInversion, RejectsAWrongAxis) {
  GradientMap const map = jet_map(81, 8);
  AxisymmetricSettings settings;
  for (double const axis : {0.1, 0.3, 0.65, 0.85}) {
    settings.axis = axis;
    EXPECT_THROW(invert_axisymmetric(map, settings), DataError) << axis;
  }
  GradientMap two_rows = map;  // few vectors suffice if they are opposite
  for (int row = 2; row < 8; ++row)
    for (int column = 0; column < 81; ++column) two_rows.valid[map.grid.index(column, row)] = 0;
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 81; ++column)
      if (std::abs(map.grid.position(column, row).x - 0.47) < 0.2) two_rows.valid[map.grid.index(column, row)] = 0;
  settings.axis = 0.47;
  EXPECT_LT(invert_axisymmetric(two_rows, settings).asymmetry, 1e-3);
  GradientMap noisy = map;
  for (Vec2d& sigma : noisy.sigma) sigma = {0.2, 0.2};
  settings.axis = 0.47;
  EXPECT_GT(invert_axisymmetric(with_noise(noisy, WindowCorrelation(81, 8, {}), 3), settings).asymmetry, 0.3);
}

// Lambda is determined from the rows that are measured; in this map, all of the eight evenly distributed rows are
// masked.
TEST(AxisymmetricInversion, ChoosesTheRegularizationFromMeasuredRows) {
  GradientMap map = jet_map(61, 16);
  for (int row = 1; row < 16; row += 2)
    for (int column = 0; column < 61; ++column) map.valid[map.grid.index(column, row)] = 0;
  AxisymmetricSettings settings;
  settings.axis = 0.47;
  settings.method = "tikhonov";
  AxisymmetricDensity const result = invert_axisymmetric(map, settings);
  EXPECT_GT(result.lambda, 0.0);
  EXPECT_TRUE(std::isfinite(result.density[result.grid.index(0, 0)]));
  EXPECT_TRUE(std::isnan(result.density[result.grid.index(0, 1)]));
}

}  // namespace
}  // namespace gladstone::inline density
