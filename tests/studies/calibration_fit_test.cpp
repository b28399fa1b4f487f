#include "studies/compare/calibration_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "render/base/units.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

constexpr double focal_length_px = 1300, plate_distance = 0.3, plate_spacing = 5e-3;
constexpr Vec2d expected_middle{159.5, 119.5};

/// Plate rotated by `tilt` about Y and moved along `motion`, a unit vector in the axes of the plate.
struct Plate {
  double tilt = 0;
  Vec3d motion{0, 0, 1};
  std::array<int, 3> moved{};  ///< error of the column index of the dots, for each plane
};

/// Computes the images of 13 x 9 dots on three planes, for a camera directed at the middle plane.
PlateDots dots_of_plate(Plate const& plate) {
  PinholeCamera const camera{{focal_length_px, focal_length_px, expected_middle.x, expected_middle.y, 0, 0, 0, 0, pi, 0,
                              0, 0, 0, plate_distance}};
  Eigen::Matrix3d const turn = Eigen::AngleAxisd(plate.tilt, Eigen::Vector3d::UnitY()).toRotationMatrix();
  PlateDots dots;
  dots.z = {-0.02, 0, 0.02};
  dots.spacing = plate_spacing;
  for (std::size_t plane = 0; plane < 3; ++plane) {
    for (int i = -6; i <= 6; ++i) {
      for (int j = -4; j <= 4; ++j) {
        Vec3d const in_plate = Vec3d{plate_spacing * i, plate_spacing * j, 0} + dots.z[plane] * plate.motion;
        Eigen::Vector3d const at = turn * Eigen::Vector3d(in_plate.x, in_plate.y, in_plate.z);
        dots.pixel.push_back(camera.project({at.x(), at.y(), at.z()}));
        dots.index.push_back({i + plate.moved[plane], j});
        dots.plane_of.push_back(plane);
      }
    }
  }
  return dots;
}

/// Fits a camera to the dots.
/// @param outer  how the middle dots of the first and the last plane were identified
Calibration fitted(PlateDots const& dots, CentreDotMethod outer = CentreDotMethod::expected_view) {
  Calibration calibration;
  calibration.columns = 320;
  calibration.rows = 240;
  for (std::size_t plane = 0; plane < dots.z.size(); ++plane) {
    CalibratedPlane& added = calibration.planes.emplace_back();
    added.file = "plane" + std::to_string(plane) + ".tif";
    added.z = dots.z[plane];
    added.found = added.used = dots.pixel.size() / dots.z.size();
    added.middle_by = plane == 1 ? CentreDotMethod::whole_grid : outer;
  }
  ExpectedCamera expected;
  expected.principal_point_px = expected_middle;
  expected.focal_length_px = focal_length_px;
  fit_calibration(calibration, dots, expected, "setup.toml");
  return calibration;
}

// The motion along the normal of a plate rotated by 30 degrees displaces its middle by 20 mm tan(30 degrees) = 2.3
// spacings, so that a middle dot wrong by one column is not noticed; offsets proportional to Z do not change the
// residuals.
TEST(CalibrationFit, CorrectsTheMiddleDotsOfTwoPlanesOfATiltedPlate) {
  for (int const sign : {1, -1}) {
    Calibration const calibration = fitted(dots_of_plate({30 * pi / 180, {0, 0, 1}, {sign, 0, -sign}}));
    EXPECT_NEAR(calibration.pinhole.camera.fx(), focal_length_px, 0.01);
    EXPECT_NEAR(calibration.pinhole.camera.fy(), focal_length_px, 0.01);
    EXPECT_EQ(calibration.drift, Vec2d{});
    EXPECT_THAT(calibration.warnings,
                testing::ElementsAre(Warns("assumed at plane0.tif"), Warns("assumed at plane2.tif")));
  }
}

// Besides the wrong middle dots, the plate moves at 20 degrees to its normal along Y. Whole offsets alone do not
// explain that. The oblique motion that does has a Z component different from the true one, which scales Z; for a plate
// that is seen at an angle, such a scale makes fx and fy unequal.
TEST(CalibrationFit, RefusesACameraOfUnequalFocalLengthsFromGuessedMiddleDots) {
  double const oblique = 20 * pi / 180;
  PlateDots const dots = dots_of_plate({40 * pi / 180, {0, std::sin(oblique), std::cos(oblique)}, {-2, 0, 2}});
  EXPECT_THAT([&] { fitted(dots); },
              ThrowsDataError(ErrorCode::inconsistent, "",
                              testing::AllOf(testing::HasSubstr("plane0.tif"), testing::HasSubstr("plane2.tif"))));
  EXPECT_THAT(fitted(dots, CentreDotMethod::whole_grid).warnings,
              testing::Contains(Warns("implausible", testing::HasSubstr("fy"))))
      << "if every image shows the whole grid, the plate's motion must be wrong";
}

// Dots that are s times as far apart as assumed, at the same Z, are seen as by a lens of s times the focal length.
TEST(CalibrationFit, WarnsOfAFocalLengthThatIsNotTheLenss) {
  auto const warnings = [](double share) {
    PlateDots dots = dots_of_plate({});
    dots.spacing *= share;
    return fitted(dots, CentreDotMethod::whole_grid).warnings;
  };
  auto const warns = testing::Contains(Warns("implausible"));
  EXPECT_THAT(warnings(0.96), warns);
  EXPECT_THAT(warnings(1.03), warns);
  EXPECT_THAT(warnings(0.99), testing::Not(warns));
  EXPECT_THAT(warnings(1), testing::IsEmpty());
}

/// A plate that is rotated in its plane before the first image.
PlateDots dots_of_turned_plane(double angle) {
  PlateDots dots = dots_of_plate({});
  double const s = std::sin(angle), c = std::cos(angle);
  for (std::size_t k = 0; k < dots.pixel.size(); ++k) {
    if (dots.plane_of[k] != 0) continue;
    Vec2d const from_middle = dots.pixel[k] - expected_middle;
    dots.pixel[k] =
        expected_middle + Vec2d{c * from_middle.x - s * from_middle.y, s * from_middle.x + c * from_middle.y};
  }
  return dots;
}

// The fitted camera rotates by a third of the angle a: 2/3 a remains in the rotated plane, 1/3 a in the others. The
// dots of a plane of 13 x 9 are sqrt(14 + 6.67) spacings of 21.7 px from its middle, rms, so that the residual is 98 px
// a sqrt(2/9) / sqrt(2) per component: 1.1 px for 2 degrees, 0.11 px for 0.2, 0.01 px for 0.02. Within a plane the dots
// scatter by at least 0.01 px: residuals from 0.05 px cause a warning, from 0.5 px a rejection.
TEST(CalibrationFit, RefusesResidualsThatTheScatterWithinPlanesDoesNotExplain) {
  double const degree = pi / 180;
  EXPECT_THAT([&] { fitted(dots_of_turned_plane(2 * degree), CentreDotMethod::whole_grid); },
              ThrowsDataError(ErrorCode::inconsistent, "plane0.tif",
                              testing::AllOf(testing::HasSubstr("1.1"), testing::HasSubstr("Z = -20 mm"))));
  EXPECT_THAT(fitted(dots_of_turned_plane(0.2 * degree), CentreDotMethod::whole_grid).warnings,
              testing::ElementsAre(
                  Warns("low_accuracy", testing::AllOf(testing::HasSubstr("0.11"), testing::HasSubstr("Z = -20 mm")))));
  EXPECT_THAT(fitted(dots_of_turned_plane(0.02 * degree), CentreDotMethod::whole_grid).warnings, testing::IsEmpty());
}

}  // namespace
}  // namespace gladstone
