#include <gtest/gtest.h>

#include <cmath>

#include "render/medium/field_volume.h"

namespace gladstone {
namespace {

MediumSetup gaussian(FieldKind kind, double radius, double thickness) {
  MediumSetup setup;
  setup.field.kind = kind;
  setup.field.amplitude = -0.2;
  setup.field.radius = radius;
  setup.thickness = thickness;
  return setup;
}

/// Integral of d n / d x along Z through the slab, beside the axis, by the midpoint rule.
double deflection(MediumSetup const& setup) {
  BuiltMedium const built = build_medium(setup);
  return std::visit(
      [&](auto const& medium) {
        Bounds<double> const box = medium.bounds();
        constexpr int slices = 4000;
        double const dz = (box.high.z - box.low.z) / slices;
        double sum = 0;
        for (int i = 0; i < slices; ++i) {
          sum += medium.sample({0.7 * setup.field.radius, 0.1 * setup.field.radius, box.low.z + (i + 0.5) * dz})
                     .gradient.x *
                 dz;
        }
        return sum;
      },
      built.view);
}

// The density of either is a product of a function of x and y and exp(-z^2/a^2), so that faces at -h and h cut
// erfc(h/a) of every integral along Z off: 0.637 of it for a = 15 mm and h = 5 mm. The midpoint rule is good to
// (h/a)^2/4000^2.
TEST(Thickness, CutsOffTheTailsOfAGaussian) {
  for (FieldKind const kind : {FieldKind::gaussian_plume, FieldKind::gaussian_blob}) {
    double const whole = deflection(gaussian(kind, 15e-3, 20 * 15e-3));
    for (double const thickness : {10e-3, 30e-3, 60e-3}) {
      MediumSetup const setup = gaussian(kind, 15e-3, thickness);
      EXPECT_NEAR(1 - deflection(setup) / whole, cut_off_share(setup), 1e-6);
    }
  }
  EXPECT_NEAR(cut_off_share(gaussian(FieldKind::gaussian_plume, 15e-3, 10e-3)), 0.637, 5e-4);
}

TEST(Thickness, AutomaticallyHoldsAllOfAGaussianThatMatters) {
  for (double const radius_mm : {0.1, 3.0, 15.0, 40.0}) {
    MediumSetup setup = gaussian(FieldKind::gaussian_plume, radius_mm * 1e-3, 0);
    setup.thickness = automatic_thickness_mm(setup.field) * 1e-3;
    EXPECT_LT(cut_off_share(setup), 1e-6) << radius_mm;
  }
  EXPECT_EQ(automatic_thickness_mm(gaussian(FieldKind::gaussian_blob, 15e-3, 0).field), 105.0);
}

// A small plume stands in 10 mm of gas as before, and so does what has no size along Z.
TEST(Thickness, IsTenMillimetresWhereTheFieldDoesNotAskForMore) {
  EXPECT_EQ(automatic_thickness_mm(gaussian(FieldKind::gaussian_plume, 1e-3, 0).field), 10.0);
  for (FieldKind const kind :
       {FieldKind::none, FieldKind::file, FieldKind::uniform_gradient, FieldKind::sinusoid, FieldKind::normal_shock}) {
    MediumSetup const setup = gaussian(kind, 15e-3, 1e-3);
    EXPECT_EQ(automatic_thickness_mm(setup.field), 10.0);
    EXPECT_EQ(cut_off_share(setup), 0.0);
  }
}

}  // namespace
}  // namespace gladstone
