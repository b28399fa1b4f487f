#include "analysis/calibration/plate_placement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "analysis/calibration/pinhole_fit.h"
#include "render/base/units.h"

namespace gladstone {
namespace {

constexpr double long_focal_length = 7059, plate_distance = 0.6;
constexpr Vec2d picture_middle{319.5, 239.5};

/// A camera with a long lens, viewing along the direction of motion.
PinholeCamera long_camera() {
  return {{long_focal_length, long_focal_length, picture_middle.x, picture_middle.y, 0, 0, 0, 0, pi, 0, 0, 0, 0,
           plate_distance}};
}

/// 13 x 9 dots 4 mm apart on three planes, on a plate rotated about Y and X relative to the direction of motion.
/// @param moved columns by which the dots of each plane are counted wrong
PlateDots dots_of_plate(double about_y, double about_x, std::array<int, 3> moved = {}) {
  PlateDots dots;
  dots.z = {-0.02, 0, 0.02};
  dots.spacing = 4e-3;
  Eigen::Matrix3d const turn =
      (Eigen::AngleAxisd(about_y, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(about_x, Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  for (std::size_t plane = 0; plane < 3; ++plane) {
    for (int i = -6; i <= 6; ++i) {
      for (int j = -4; j <= 4; ++j) {
        Eigen::Vector3d const at = turn * Eigen::Vector3d(dots.spacing * i, dots.spacing * j, 0);
        dots.pixel.push_back(long_camera().project({at.x(), at.y(), at.z() + dots.z[plane]}));
        dots.index.push_back({i + moved[plane], j});
        dots.plane_of.push_back(plane);
      }
    }
  }
  return dots;
}

// In the axes of the plate the direction of motion is the last row of its rotation matrix: (-sin a cos b, sin b, cos a
// cos b) for rotations by a about Y and b about X. The principal point is determined to 1 px, the drift to 1 / f.
TEST(PlatePlacement, TheDriftOfATiltedPlateIsFound) {
  double const a = 5 * pi / 180, b = -3 * pi / 180;
  PlateDots const dots = dots_of_plate(a, b);
  PinholeFit const without = fit_pinhole(dots.points(), picture_middle);
  // Without the correction, the drift by tan(5 degrees) per unit of motion moves the principal point by f tan a = 618
  // px; the fit assigns part of it to the orientation.
  EXPECT_GT(std::abs(without.camera.cx() - picture_middle.x), 300)
      << "the drift has a large effect without the correction";
  auto const placement = find_drift(dots, picture_middle);
  ASSERT_TRUE(placement);
  EXPECT_TRUE(placement->moved.empty());
  EXPECT_NEAR(placement->drift.x, -std::sin(a) * std::cos(b), 1.5 / long_focal_length);
  EXPECT_NEAR(placement->drift.y, std::sin(b), 1.5 / long_focal_length);
  PinholeFit const fit = fit_pinhole(dots.points(*placement), picture_middle);
  // a drift error of e = 1 / f changes fx by its product with the rotation, e sin a f < 0.1 px
  EXPECT_NEAR(fit.camera.fx(), long_focal_length, 0.2);
  EXPECT_NEAR(fit.camera.fy(), long_focal_length, 0.2);
  EXPECT_NEAR(fit.camera.cx(), picture_middle.x, 2);
}

TEST(PlatePlacement, APlateThatMovesAlongItsNormalHasNoDrift) {
  auto const placement = find_drift(dots_of_plate(0, 0), picture_middle);
  ASSERT_TRUE(placement);
  EXPECT_EQ(placement->drift, Vec2d{});
  EXPECT_TRUE(placement->moved.empty());
}

TEST(PlatePlacement, FindsCentreDotOffByOne) {
  for (std::size_t plane = 0; plane < 3; ++plane) {
    std::array<int, 3> moved{};
    moved[plane] = 1;
    PlateDots const dots = dots_of_plate(0, 0, moved);
    auto const placement = find_misidentified_centres(dots, picture_middle);
    ASSERT_TRUE(placement) << plane;
    for (std::size_t other = 0; other < 3; ++other) {
      EXPECT_EQ(placement->moved[other], (std::array<int, 2>{-moved[other], 0})) << plane;
    }
    EXPECT_NEAR(fit_pinhole(dots.points(*placement), picture_middle).camera.fx(), long_focal_length, 1e-3);
  }
  EXPECT_FALSE(find_misidentified_centres(dots_of_plate(0.01, 0), picture_middle));
}

// An index error that grows by one column per plane is a drift by whole spacings, which causes no residual.
TEST(PlatePlacement, FindsCentreDotsThatDrift) {
  PlateDots const dots = dots_of_plate(0, 0, {-1, 0, 1});
  EXPECT_LT(fit_pinhole(dots.points(), picture_middle).rms_px, 1e-6);
  auto const placement = find_drift(dots, picture_middle);
  ASSERT_TRUE(placement);
  ASSERT_EQ(placement->moved.size(), 3u);
  EXPECT_EQ(placement->moved[0], (std::array<int, 2>{1, 0}));
  EXPECT_EQ(placement->moved[1], (std::array<int, 2>{0, 0}));
  EXPECT_EQ(placement->moved[2], (std::array<int, 2>{-1, 0}));
}

// Index offsets displace the dots within the plates by whole spacings s, which for a plate turned by 30 degrees is not
// a motion at an angle: an oblique motion by d reduces the distance between the planes by sqrt(1 - d^2), here by 2 %.
TEST(PlatePlacement, MiddleDotsOfTwoPlanesOfATiltedPlateAreFound) {
  double const tilt = 30 * pi / 180;
  for (int const sign : {1, -1}) {
    PlateDots dots = dots_of_plate(0, 0, {-sign, 0, sign});
    // A plate that is rotated about Y and moved along its own normal.
    Eigen::Matrix3d const turn = Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
    for (std::size_t k = 0; k < dots.pixel.size(); ++k) {
      std::size_t const plane = dots.plane_of[k];
      int const column = dots.index[k][0] - (static_cast<int>(plane) - 1) * sign;
      Eigen::Vector3d const at =
          turn * Eigen::Vector3d(dots.spacing * column, dots.spacing * dots.index[k][1], dots.z[plane]);
      dots.pixel[k] = long_camera().project({at.x(), at.y(), at.z()});
    }
    EXPECT_LT(fit_pinhole(dots.points(), picture_middle).rms_px, 1e-6) << "the residuals do not show the error";
    auto const placement = find_drift(dots, picture_middle);
    ASSERT_TRUE(placement);
    EXPECT_THAT(placement->moved, testing::ElementsAre(std::array<int, 2>{sign, 0}, std::array<int, 2>{0, 0},
                                                       std::array<int, 2>{-sign, 0}));
    PinholeFit const fit = fit_pinhole(dots.points(*placement), picture_middle);
    EXPECT_NEAR(fit.camera.fx(), long_focal_length, 0.01);
    EXPECT_NEAR(fit.camera.fy(), long_focal_length, 0.01);
  }
}

// Index errors of two planes that are not proportional to Z appear in the residuals, except for a part proportional to
// Z.
TEST(PlatePlacement, MiddleDotsOfTwoPlanesThatAreOffDifferentlyAreFound) {
  for (std::array<int, 3> const moved : {std::array<int, 3>{-1, 0, 2}, {2, 0, 1}, {0, 1, -2}}) {
    PlateDots const dots = dots_of_plate(0, 0, moved);
    auto const placement = find_misidentified_centres(dots, picture_middle);
    ASSERT_TRUE(placement);
    std::vector<int> sums;  // equal in all planes if the offsets are corrected
    for (std::size_t plane = 0; plane < 3; ++plane) {
      sums.push_back(placement->moved[plane][0] + moved[plane]);
      EXPECT_EQ(placement->moved[plane][1], 0);
    }
    EXPECT_THAT(sums, testing::Each(sums[0])) << moved[0] << " " << moved[1] << " " << moved[2];
    EXPECT_NEAR(fit_pinhole(dots.points(*placement), picture_middle).camera.fx(), long_focal_length, 1e-3);
  }
}

TEST(PlatePlacement, FindsPermutedImages) {
  PlateDots dots = dots_of_plate(0.02, 0.01);
  EXPECT_FALSE(find_image_order(dots));
  for (std::size_t& plane : dots.plane_of) plane = plane == 1 ? 2 : plane == 2 ? 1 : 0;
  auto const order = find_image_order(dots);
  ASSERT_TRUE(order);
  EXPECT_EQ(*order, (std::vector<std::size_t>{0, 2, 1}));
}

}  // namespace
}  // namespace gladstone
