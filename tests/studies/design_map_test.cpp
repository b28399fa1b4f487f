#include "studies/figures/design_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "studies/figures/excluded_designs.h"
#include "tests/studies/support/requirement_bounds.h"
#include "tests/studies/support/table1_design.h"

namespace gladstone {
namespace {

/// Returns the limit whose area of the map contains a set-up; empty: none.
std::string excluding_limit(std::vector<ExcludedDesigns> const& excluded, DesignPoint<double> const& bench) {
  double const x = bench.sensitivity(), y = resolved_wavelength(bench);
  for (ExcludedDesigns const& one : excluded) {
    for (MapArea const& area : one.areas) {
      bool const across = x > area.least_sensitivity && x < area.most_sensitivity;
      if (across && y > area.least_wavelength && y < area.most_wavelength) return one.limit;
    }
  }
  return "";
}

std::string excluding_limit(DesignQuestion const& question, DesignPoint<double> const& bench) {
  return excluding_limit(excluded_designs(bench, &question), bench);
}

// A set-up lies in a shaded area exactly if it misses the requirement.
TEST(DesignMap, ShadesWhatARequirementExcludes) {
  FixedDesignParameters const given = table1_given();
  DesignPoint<double> const bench = table1_design(given);
  using testing::StartsWith;
  DesignQuestion finer, coarser;
  finer.requirements.limits = {{required::resolution, 0.9 * resolved_wavelength(bench)}};
  coarser.requirements.limits = {{required::resolution, 1.1 * resolved_wavelength(bench)}};
  EXPECT_THAT(excluding_limit(finer, bench), StartsWith("requirements.resolution_mm = "));
  EXPECT_EQ(excluding_limit(coarser, bench), "");
  DesignQuestion sensitive, blunt;
  sensitive.requirements.limits = {{required::gradient_min, 0.9 * bench.smallest_gradient()}};
  blunt.requirements.limits = {{required::gradient_min, 1.1 * bench.smallest_gradient()}};
  EXPECT_THAT(excluding_limit(sensitive, bench), StartsWith("requirements.gradient_min_kg_m4 = "));
  EXPECT_EQ(excluding_limit(blunt, bench), "");
}

// The areas end at the required wavelength, to within half a row: the wavelength grows at most in proportion to the
// aperture, and 240 rows span f/2.8 to f/32, so half a row is at most (32 / 2.8)^(1/480) = 1.0051. They extend to the
// curve of f/2.8.
TEST(DesignMap, AreasOfTheResolutionEndAtTheRequiredWavelength) {
  FixedDesignParameters const given = table1_given();
  DesignPoint<double> const bench = table1_design(given);
  DesignQuestion question;
  question.requirements.limits = {{required::resolution, 4e-3}};
  std::vector<ExcludedDesigns> const excluded = excluded_designs(bench, &question);
  ASSERT_FALSE(excluded.empty());
  ASSERT_EQ(excluded.front().limit, "requirements.resolution_mm = 4");
  double finest = 1;
  for (MapArea const& area : excluded.front().areas) finest = std::min(finest, area.least_wavelength);
  EXPECT_GT(finest, 4e-3 / 1.0051);
  EXPECT_LT(finest, 4e-3 * 1.0051);
  DesignPoint<double> const widest = *design_on_map(bench, map_f_numbers.front() * 1.001, bench.z_d);
  EXPECT_EQ(excluding_limit(excluded, widest), "requirements.resolution_mm = 4");
}

TEST(DesignMap, NamesTheLimitsOfTheSetUp) {
  FixedDesignParameters given = table1_given();
  DesignPoint<double> const bench = table1_design(given);
  DesignQuestion question;
  question.free.push_back({Choice::z_d, {}, 0.1, 0.2});
  EXPECT_EQ(excluding_limit(question, bench), "limits.z_d_mm = [100, 200]");
  question.free.front().high = 0.3;
  EXPECT_EQ(excluding_limit(question, bench), "");
  given.thickness = 0.6;  // 300 mm of medium on either side of its middle, 250 mm before the dots
  EXPECT_EQ(excluding_limit(excluded_designs(bench, nullptr), bench), "dots outside the medium");
}

}  // namespace
}  // namespace gladstone
