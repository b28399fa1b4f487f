#include "studies/oracles/validate.h"

#include <gtest/gtest.h>

#include <limits>

#include "render/render.h"

namespace gladstone {
namespace {

TEST(Oracles, AreMetByTheCpu) {
  Device renderer = cpu();
  auto const results = run_oracles(renderer);
  EXPECT_GE(results.size(), 20u);
  for (OracleResult const& result : results) {
    EXPECT_TRUE(result.passed()) << result.oracle.name << ": " << result.measured << ", not " << result.oracle.exact;
  }
}

TEST(Oracles, MissWhatIsOffByMoreThanTheTolerance) {
  Oracle const relative{"r", "", 2.0, 0.1, ToleranceKind::relative, nullptr};
  EXPECT_TRUE((OracleResult{relative, 2.19}.passed()));
  EXPECT_FALSE((OracleResult{relative, 2.21}.passed()));
  EXPECT_FALSE((OracleResult{relative, -2.0}.passed()));
  Oracle const absolute{"a", "", 0.0, 0.1, ToleranceKind::absolute, nullptr};
  EXPECT_TRUE((OracleResult{absolute, -0.09}.passed()));
  EXPECT_FALSE((OracleResult{absolute, -0.11}.passed()));
  EXPECT_FALSE((OracleResult{absolute, std::numeric_limits<double>::quiet_NaN()}.passed()));
}

}  // namespace
}  // namespace gladstone
