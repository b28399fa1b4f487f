#include <gtest/gtest.h>

#include "render/medium/field_volume.h"

namespace gladstone {
namespace {

template <class Field>
MediumSetup gaussian(double radius, double thickness) {
  MediumSetup setup;
  setup.field = Field{{{}, -0.2, radius}};
  setup.thickness = thickness;
  return setup;
}
using Plume = GaussianPlume<double>;
using Blob = GaussianBlob<double>;

/// Integrates d n / d x along Z through the slab, at a distance from the axis, by the midpoint rule.
double deflection(MediumSetup const& setup) {
  BuiltMedium const built = build_medium(setup);
  return std::visit(
      [&](auto const& medium) {
        Bounds<double> const box = medium.bounds();
        constexpr int slices = 4000;
        double const dz = (box.high.z - box.low.z) / slices;
        double const radius = radius_along_z(setup.field);
        double sum = 0;
        for (int i = 0; i < slices; ++i) {
          sum += medium.sample({0.7 * radius, 0.1 * radius, box.low.z + (i + 0.5) * dz}).gradient.x * dz;
        }
        return sum;
      },
      built.view);
}

// The density of plume and blob is a product of a function of x and y and exp(-z^2/a^2), so that faces at -h and h
// remove the fraction erfc(h/a) of every integral along Z: 0.637 for a = 15 mm and h = 5 mm. The error of the midpoint
// rule is (h/a)^2/4000^2.
template <class Field>
class GaussianThickness : public testing::Test {};
using GaussianFields = testing::Types<Plume, Blob>;
TYPED_TEST_SUITE(GaussianThickness, GaussianFields);

TYPED_TEST(GaussianThickness, CutsOffTheTails) {
  double const whole = deflection(gaussian<TypeParam>(15e-3, 20 * 15e-3));
  for (double const thickness : {10e-3, 30e-3, 60e-3}) {
    MediumSetup const setup = gaussian<TypeParam>(15e-3, thickness);
    EXPECT_NEAR(1 - deflection(setup) / whole, truncated_fraction(setup), 1e-6);
  }
  EXPECT_NEAR(truncated_fraction(gaussian<TypeParam>(15e-3, 10e-3)), 0.637, 5e-4);
}

TEST(Thickness, AutomaticallyHoldsAllOfAGaussianThatMatters) {
  for (double const radius_mm : {0.1, 3.0, 15.0, 40.0}) {
    MediumSetup setup = gaussian<Plume>(radius_mm * 1e-3, 0);
    setup.thickness = automatic_thickness_mm(setup.field) * 1e-3;
    EXPECT_LT(truncated_fraction(setup), 1e-6) << radius_mm;
  }
  EXPECT_EQ(automatic_thickness_mm(gaussian<Blob>(15e-3, 0).field), 105.0);
}

// The automatic thickness is 10 mm for a thin plume and for fields without a length scale along Z.
TEST(Thickness, IsTenMillimetresWhereTheFieldDoesNotAskForMore) {
  EXPECT_EQ(automatic_thickness_mm(gaussian<Plume>(1e-3, 0).field), 10.0);
  FieldSetup file;
  file.kind = FieldKind::file;
  for (FieldSetup const& field :
       {FieldSetup{}, file, FieldSetup(UniformGradient<double>{{}, {10, 0, 0}}),
        FieldSetup(Sinusoid<double>::wave(0.1, 15e-3)), FieldSetup(NormalShock<double>::front(2, 0.5, 15e-3))}) {
    MediumSetup setup;
    setup.field = field;
    setup.thickness = 1e-3;
    EXPECT_EQ(automatic_thickness_mm(setup.field), 10.0);
    EXPECT_EQ(truncated_fraction(setup), 0.0);
  }
}

}  // namespace
}  // namespace gladstone
