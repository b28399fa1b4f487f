#include <gtest/gtest.h>

#include <cmath>

#include "render/base/units.h"
#include "render/optics/apparent_pupil.h"
#include "render/optics/field_analysis.h"
#include "render/optics/paraxial.h"
#include "render/optics/trace_back.h"
#include "tests/optics/lens_fixtures.h"

namespace gladstone {
namespace {

/// A fisheye lens of 17 surfaces for 170 degrees, focal length 0.205 mm. Its entrance pupil moves forwards and tilts
/// with the field angle: beyond about 50 degrees, rays through the paraxial pupil do not pass the first lenses.
Lens wide_lens() {
  Prescription prescription = read_prescription(GLADSTONE_DATA_DIR "/../tests/cases/lenses/wide_170.toml");
  double const wavelength = prescription.primary_wavelength;
  return build_lens(std::move(prescription), GlassCatalogue::shipped(), wavelength);
}

struct ChiefRay {
  double degrees;
  double aim_mm;    ///< height on the tangent plane of the first vertex
  double image_mm;  ///< height on the paraxial image plane, 0.832527873288451 mm behind the last vertex
};

// Reference values from an independent ray tracer in Python (spheres by the quadratic formula): rays started at the
// centre of the stop, with the slope in the stop found by bisection so that they reach the object, then traced through
// the whole lens.
constexpr ChiefRay listing[] = {
    {10, -0.24555132315715886, 0.03568273422133241}, {30, -0.7648619872884432, 0.10458230256032489},
    {40, -1.0576281895988204, 0.13669240518909703},  {50, -1.3945640719594576, 0.16661085700531653},
    {60, -1.8140473906059396, 0.19389152423315703},  {70, -2.4259306890329735, 0.21799976057488962},
    {80, -3.77931690073447, 0.23820878749041827},    {85, -6.117666681375671, 0.2465792908059219}};

RayOrigin field(double degrees) {
  double const angle = degrees * unit::degree;
  return RayOrigin::direction({0, std::sin(angle), std::cos(angle)});
}

// Chief rays meet the stop's centre to 1e-10 of its radius (0.35 mm), and the aim plane to that over the cosine. The
// reference values are as exact as bisection in double: 1e-9 mm for both.
TEST(WideAngleLens, ChiefRaysToEightyFiveDegreesFollowAnIndependentTracer) {
  Lens const lens = wide_lens();
  ParaxialLens const paraxial = paraxial_lens(lens);
  EXPECT_NEAR(paraxial.back_focal_length * 1e3, 0.832527873288451, 1e-12);
  double const z = lens.poses.back().origin.z + paraxial.back_focal_length;
  for (auto const& [degrees, aim, image] : listing) {
    auto const disc = find_apparent_pupil(lens, field(degrees));
    ASSERT_TRUE(disc) << degrees;
    EXPECT_NEAR(disc->centre.x * 1e3, 0, 1e-9) << degrees;
    EXPECT_NEAR(disc->centre.y * 1e3, aim, 1e-8) << degrees;
    Ray<double> ray = field(degrees).ray_through(disc->centre);
    RayAccount<double> account;
    ASSERT_EQ(lens.view().carry(ray, account), RayStatus::alive) << degrees;
    double const y = ray.position.y + (z - ray.position.z) * ray.direction.y / ray.direction.z;
    EXPECT_NEAR(y * 1e3, image, 1e-9) << degrees;
  }
}

// A ray traced backwards from the stop's centre and then reversed returns to the stop's centre with its initial slope:
// through glass, and through an ideal lens in front of the stop, which is exact in slopes for one direction only.
TEST(TraceBack, IsTheReverseOfTracingForwards) {
  Prescription prescription =
      lens_of({{50, 5, 1.5}, {-80, 20, 1}, {HUGE_VAL, 10, 1}, {HUGE_VAL, 10, 1, true}}, 5).prescription;
  prescription.surfaces[2].shape = PrescribedSurface::Shape::ideal_lens;
  prescription.surfaces[2].focal_length = 90 * unit::millimetre;
  Lens const ideal = build_lens(prescription, GlassCatalogue::shipped(), spectral_line::d), wide = wide_lens();
  for (Lens const* lens : {&wide, &ideal}) {
    Vec2d const slope{0.02, -0.05};
    auto const back = trace_back_from_stop(lens->surfaces, lens->stop, slope);
    ASSERT_TRUE(back);
    Ray<double> ray{back->position + 0.01 * back->direction, -1.0 * back->direction};
    RayAccount<double> account;
    int failed_at;
    ASSERT_EQ(lens->view().carry(ray, account, 0, lens->stop, failed_at), RayStatus::alive);
    Ray<double> const local = lens->poses[static_cast<std::size_t>(lens->stop)].inwards(ray);
    double const way = -local.position.z / local.direction.z;
    EXPECT_NEAR(local.position.x + way * local.direction.x, 0, 1e-14);
    EXPECT_NEAR(local.position.y + way * local.direction.y, 0, 1e-14);
    EXPECT_NEAR(local.direction.x / local.direction.z, slope.x, 1e-11);
    EXPECT_NEAR(local.direction.y / local.direction.z, slope.y, 1e-11);
  }
}

// Symmetry: rotating the field about the axis rotates the pupil as seen from it.
TEST(WideAngleLens, PupilIsRotationallySymmetric) {
  Lens const lens = wide_lens();
  double const s = std::sin(70 * unit::degree), c = std::cos(70 * unit::degree);
  auto const along_y = find_apparent_pupil(lens, RayOrigin::direction({0, s, c}));
  ASSERT_TRUE(along_y);
  for (double const turn : {0.3, 1.7, -2.5}) {
    auto const turned = find_apparent_pupil(lens, RayOrigin::direction({s * std::sin(turn), s * std::cos(turn), c}));
    ASSERT_TRUE(turned) << turn;
    EXPECT_NEAR(turned->centre.x, along_y->centre.y * std::sin(turn), 1e-11);
    EXPECT_NEAR(turned->centre.y, along_y->centre.y * std::cos(turn), 1e-11);
  }
}

// No light of the source is lost: of a lattice three times as wide as the ellipse, every ray that passes the stop
// crosses the aim plane inside the ellipse. Most rays through the ellipse pass the stop, so that it is no wider than
// its margin requires.
TEST(WideAngleLens, AimDiscHoldsEveryRayThatPassesTheStop) {
  Lens const lens = wide_lens();
  for (double const degrees : {0.0, 30.0, 45.0, 50.0, 55.0, 60.0, 70.0, 80.0}) {
    auto const disc = find_apparent_pupil(lens, field(degrees));
    ASSERT_TRUE(disc) << degrees;
    int passed = 0, outside = 0, within = 0;
    constexpr int half = 150;
    for (int i = -half; i <= half; ++i) {
      for (int j = -half; j <= half; ++j) {
        Vec2d const at{3.0 * i / half, 3.0 * j / half};
        auto const place = intersect_stop(lens, field(degrees).ray_through(disc->at(at)));
        bool const inside = length(at) <= 1, passes = place && length(*place) <= lens.stop_radius;
        within += inside ? 1 : 0;
        passed += passes ? 1 : 0;
        outside += passes && !inside ? 1 : 0;
      }
    }
    EXPECT_EQ(outside, 0) << degrees;
    EXPECT_GT(passed, 0.8 * within) << degrees;
  }
}

// Results of `info lens` in the image plane at the back focal length: all rays of the stop pass at every field angle of
// the file and at 80 degrees.
TEST(WideAngleLens, ImagesItsWholeField) {
  Lens lens = wide_lens();
  lens.image_distance.reset();
  lens.prescription.field_angles = {0.0, 60 * unit::degree, 80 * unit::degree, 85 * unit::degree};
  FieldAnalysis const analysis = analyse_field(lens, paraxial_lens(lens), 400);
  for (FieldPoint const& point : analysis.points) {
    EXPECT_TRUE(point.imaged) << point.angle / unit::degree;
    EXPECT_EQ(point.vignetting, 0) << point.angle / unit::degree;
    for (auto const& [degrees, aim, image] : listing) {
      if (std::abs(degrees * unit::degree - point.angle) > 1e-9) continue;
      EXPECT_NEAR(point.chief.y * 1e3, image, 1e-9) << degrees;
    }
  }
}

}  // namespace
}  // namespace gladstone
