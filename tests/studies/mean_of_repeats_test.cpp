#include "studies/report/mean_of_repeats.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gladstone {
namespace {

DisplacementField measured(Vec2d first, Vec2d second) {
  DisplacementField field;
  field.position_px = {{8, 8}, {24, 8}};
  field.displacement_px = {first, second};
  return field;
}

// The mean of 0.1, 0.2 and 0.6 px is 0.3, the variance (0.04 + 0.01 + 0.09) / 2 = 0.07, and that of the mean a third of
// it (JCGM 100:2008, 4.2.3). A vector that is invalid or NaN in one repeat is excluded from the mean.
TEST(MeanOfRepeats, HasTheStandardDeviationOfTheMean) {
  std::vector<DisplacementField> all{measured({0.1, 0}, {1, 1}), measured({0.2, 0}, {1, 1}),
                                     measured({0.6, 0}, {1, 1})};
  all[1].status = {VectorStatus::valid, VectorStatus::masked};
  MeanOfRepeats const mean = mean_of_repeats(all, 0.03);
  EXPECT_EQ(mean.count, 3u);
  EXPECT_NEAR(mean.field.displacement_px[0].x, 0.3, 1e-15);
  EXPECT_NEAR(mean.field.sigma_px[0].x, std::sqrt(0.07 / 3), 1e-15);
  EXPECT_NEAR(mean.field.sigma_px[0].y, 0, 1e-15);
  EXPECT_TRUE(mean.field.counts(0));
  EXPECT_FALSE(mean.field.counts(1));
  EXPECT_TRUE(std::isnan(mean.field.sigma_px[1].x));
  // each has 0.03 px by the formula: their mean has a third of the variance
  EXPECT_NEAR(mean.estimated_px, 0.03 / std::sqrt(3), 1e-15);
}

TEST(MeanOfRepeats, OfOneIsThatOne) {
  DisplacementField one = measured({0.1, 0.2}, {0.3, 0.4});
  one.sigma_px = {{0.01, 0.02}, {0.03, 0.04}};
  MeanOfRepeats const mean = mean_of_repeats({one}, 0.5);
  EXPECT_EQ(mean.count, 1u);
  EXPECT_EQ(mean.field.displacement_px[1].y, 0.4);
  EXPECT_EQ(mean.field.sigma_px[1].y, 0.04);
}

}  // namespace
}  // namespace gladstone
