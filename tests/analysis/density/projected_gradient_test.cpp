#include "analysis/density/projected_gradient.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "tests/support/expect_error.h"

namespace gladstone::inline density {
namespace {

/// Table 1 of Rajendran, Bane & Vlachos: 105 mm lens, Z_A = 750 mm, Z_D = 250 mm, pixels of 10 um, M = f/(Z_B - f).
ProjectionOptics table_1() { return {0.105 / (1.0 - 0.105), 0.75, 0.25, 10e-6, 2.26e-4, 1.00027685, {255.5, 255.5}}; }

DisplacementField make_field(Vec2d displacement) {
  DisplacementField field;
  field.columns = 5;
  field.rows = 4;
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 5; ++column) {
      field.position_px.push_back({15.5 + 16.0 * column, 31.5 + 16.0 * row});
      field.displacement_px.push_back(displacement);
      field.sigma_px.push_back({0.02, 0.04});
    }
  return field;
}

// By Eq. 9 a gradient of 10 kg/m^4 over 10 mm shifts the dots by -10 kg/m^4 10 mm Z_D K/n0 = -5.64844e-6 m in their
// plane, i.e. by -5.64844e-6 m M/p = -0.066267 px to the right, and upwards (v < 0) for a gradient that points down.
TEST(ProjectedGradient, InvertsEquationNine) {
  ProjectionOptics const optics = table_1();
  double const shift_px = -5.64843623042961e-6 * optics.magnification / optics.pixel_pitch;
  ProjectedGradient const result = compute_projected_gradient(make_field({shift_px, shift_px}), optics);
  GradientMap const mean = compute_mean_gradient(result.map, 0.01);
  for (Vec2d const& g : mean.gradient) {
    EXPECT_NEAR(g.x, 10.0, 1e-8);
    EXPECT_NEAR(g.y, -10.0, 1e-8);
  }
  EXPECT_NEAR(result.map.sigma[0].x, 0.02 / optics.sensitivity(), 1e-12);
  EXPECT_NEAR(mean.sigma[0].y, 0.04 / optics.sensitivity() / 0.01, 1e-9);
}

// Row 0 of the map is the lowest row of the image; the nodes are those of the mid-plane, (px - axis) p / M_A.
TEST(ProjectedGradient, HasItsRowsUpwards) {
  DisplacementField field = make_field({});
  field.displacement_px[0] = {0.5, 0.25};  // top left vector
  ProjectionOptics const optics = table_1();
  GradientMap const map = compute_projected_gradient(field, optics).map;
  PlaneGrid const& grid = map.grid;
  EXPECT_LT(map.gradient[grid.index(0, 3)].x, 0.0);
  EXPECT_GT(map.gradient[grid.index(0, 3)].y, 0.0);
  double const medium_magnification = optics.magnification * 1.0 / 0.75;
  EXPECT_NEAR(grid.spacing.x, 16.0 * 10e-6 / medium_magnification, 1e-15);
  EXPECT_NEAR(grid.position(0, 3).x, (15.5 - 255.5) * 10e-6 / medium_magnification, 1e-15);
  EXPECT_NEAR(grid.position(0, 3).y, (255.5 - 31.5) * 10e-6 / medium_magnification, 1e-15);
}

TEST(ProjectedGradient, LeavesHolesAndCountsVectorsWithoutSigma) {
  DisplacementField field = make_field({0.1, 0.1});
  field.status.assign(field.size(), VectorStatus::valid);
  field.status[7] = VectorStatus::masked;
  field.displacement_px[7] = {std::nan(""), std::nan("")};
  field.status[8] = VectorStatus::replaced;
  field.sigma_px[8] = {std::nan(""), std::nan("")};
  field.sigma_px[2] = {0.3, 0.1};
  ProjectionOptics const optics = table_1();
  ProjectedGradient const result = compute_projected_gradient(field, optics);
  EXPECT_EQ(result.invalid, 1u);
  EXPECT_EQ(result.without_sigma, 1u);
  EXPECT_FALSE(result.map.is_valid(2, 2));  // vector 7: column 2 of image row 1
  EXPECT_NEAR(result.map.sigma[result.map.grid.index(3, 2)].x, 0.3 / optics.sensitivity(), 1e-12);
  for (Vec2d& sigma : field.sigma_px) sigma = {std::nan(""), std::nan("")};
  EXPECT_TRUE(compute_projected_gradient(field, optics).map.sigma.empty());
}

TEST(ProjectedGradient, RejectsBadInput) {
  DisplacementField const field = make_field({0.1, 0.1});
  ProjectionOptics optics = table_1();
  optics.target_distance = 0.0;
  optics.gladstone_dale = std::nan("");
  try {
    compute_projected_gradient(field, optics);
    FAIL();
  } catch (SetupError const& error) {
    EXPECT_EQ(error.problems().size(), 2u);
  }
  DisplacementField scattered = field;
  scattered.columns = scattered.rows = 0;
  EXPECT_THAT([&] { compute_projected_gradient(scattered, table_1()); },
              ThrowsDataError(ErrorCode::wrong_shape, "vectors"));
  DisplacementField irregular = field;
  irregular.position_px[6].x += 0.5;
  EXPECT_THAT([&] { compute_projected_gradient(irregular, table_1()); },
              ThrowsDataError(ErrorCode::invalid_value, "vectors"));
  DisplacementField not_finite = field;
  not_finite.displacement_px[3].x = std::nan("");
  EXPECT_THAT([&] { compute_projected_gradient(not_finite, table_1()); },
              ThrowsDataError(ErrorCode::invalid_value, "density gradient"));
  DisplacementField none = field;
  none.status.assign(field.size(), VectorStatus::invalid);
  EXPECT_THAT([&] { compute_projected_gradient(none, table_1()); },
              ThrowsDataError(ErrorCode::no_valid_vector, "density gradient"));
  EXPECT_THROW(compute_mean_gradient(compute_projected_gradient(field, table_1()).map, 0.0), SetupError);
}

}  // namespace
}  // namespace gladstone::inline density
