#include "render/scene/field_coverage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

Bounds<double> box(double width, double height, Vec2d centre = {}) {
  return {{centre.x - width / 2, centre.y - height / 2, -5e-3}, {centre.x + width / 2, centre.y + height / 2, 5e-3}};
}

// Table 1 with 512 px of 10 um: M = 0.117318, so that 43.642 mm are seen at the dots and Z_A / Z_B of that, 32.732 mm,
// at the mid-plane, which chief rays cross three quarters of the way to the lens.
TEST(FieldCoverage, IsTheShareOfTheViewAtTheField) {
  FieldCoverage const seen = field_coverage(box(10e-3, 20e-3), table1_setup(512));
  EXPECT_NEAR(seen.view.x, 32.732e-3, 1e-6);
  EXPECT_NEAR(seen.share, 10e-3 * 20e-3 / (seen.view.x * seen.view.y), 1e-12);
  EXPECT_NEAR(seen.ratio, 20e-3 / seen.view.y, 1e-12);
  EXPECT_THAT(seen.warning(), IsEmpty());
  // half of it beyond the view's edge
  FieldCoverage const beside = field_coverage(box(10e-3, 20e-3, {seen.view.x / 2, 0}), table1_setup(512));
  EXPECT_NEAR(beside.share, seen.share / 2, 1e-12);
}

TEST(FieldCoverage, WarnsOfAFieldThatFillsLittle) {
  EXPECT_THAT(field_coverage(box(9e-3, 11e-3), table1_setup(512)).warning(),
              AllOf(HasSubstr("fills 9.2 % of the 32.73 x 32.73 mm"), HasSubstr("spacing_mm")));
  EXPECT_THAT(field_coverage(box(32e-3, 32e-3, {0.1, 0}), table1_setup(512)).warning(), HasSubstr("fills 0 %"));
}

// Metres or micrometres taken for millimetres.
TEST(FieldCoverage, NamesTheUnitThatWouldFit) {
  EXPECT_THAT(field_coverage(box(32e-6, 32e-6), table1_setup(512)).warning(),
              HasSubstr("were its lengths in metres, it would be 32 x 32 mm wide"));
  EXPECT_THAT(field_coverage(box(32, 32), table1_setup(512)).warning(),
              HasSubstr("were its lengths in um, it would be 32 x 32 mm wide"));
  EXPECT_THAT(field_coverage(box(1, 1), table1_setup(512)).warning(), IsEmpty()) << "large, and why not";
}

TEST(FieldCoverage, HasNothingToSayOfFieldsWithoutEnd) {
  FieldCoverage const slab =
      field_coverage({{-unbounded, -unbounded, -5e-3}, {unbounded, unbounded, 5e-3}}, table1_setup(512));
  EXPECT_EQ(slab.share, 1.0);
  EXPECT_THAT(slab.warning(), IsEmpty());
}

}  // namespace
}  // namespace gladstone
