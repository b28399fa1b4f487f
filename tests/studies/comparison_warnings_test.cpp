#include "studies/compare/comparison_warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Four vectors with a true displacement and errors of both signs in u: the rms is error / sqrt(2) per component.
Warnings warnings_of(double displacement_px, double error_px, Setup const& setup = {}) {
  Comparison comparison;
  comparison.mask.assign(4, 1);
  comparison.point.displacement_px.assign(4, {displacement_px, displacement_px});
  comparison.window.displacement_px = comparison.point.displacement_px;
  for (int i = 0; i < 4; ++i) {
    double const error = i % 2 == 0 ? error_px : -error_px;
    comparison.measured.displacement_px.push_back({displacement_px + error, displacement_px});
  }
  return comparison_warnings(comparison, setup);
}

TEST(ComparisonWarnings, WarnOfUnmeasurableSignal) {
  EXPECT_THAT(warnings_of(0.5, 0.01), IsEmpty());
  EXPECT_THAT(warnings_of(0.004, 0.001),
              ElementsAre(Warns("unreliable", testing::AllOf(HasSubstr("0.004 px"), HasSubstr("0.01 px")))));
  EXPECT_THAT(warnings_of(0.05, 0.1),
              ElementsAre(Warns("unreliable",
                                testing::AllOf(HasSubstr("0.05 px"), HasSubstr("0.071 px"), HasSubstr("z_d_mm")))));
  EXPECT_THAT(warnings_of(0, 0.001), IsEmpty()) << "the true displacement is zero";
}

TEST(ComparisonWarnings, TellOfImagesThatLockToPixels) {
  gladstone::Setup setup;
  setup.target.dot_diameter_px = 1;
  EXPECT_THAT(warnings_of(0.5, 0.01, setup), ElementsAre(Warns("unsuitable", HasSubstr("1.49 px"))));
}

}  // namespace
}  // namespace gladstone
