#include "studies/case/case_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "studies/compare/comparison_kind.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

template <class Kinds>
auto count_kinds(Kinds const& kinds, Experiment const& experiment) {
  return std::count_if(kinds.begin(), kinds.end(), [&](auto const* kind) { return &kind->experiment == &experiment; });
}

TEST(CaseKind, EveryExperimentHasOneKindOfCaseAndIfCorrelatedOfComparison) {
  for (Experiment const* one : all_experiments) {
    EXPECT_EQ(count_kinds(all_case_kinds, *one), 1) << one->name;
    EXPECT_EQ(count_kinds(all_comparison_kinds, *one), one->correlated ? 1 : 0) << one->name;
  }
}

TEST(CaseKind, OtherExperimentsAreRefused) {
  gladstone::Setup setup;
  EXPECT_NO_THROW(require_experiment(setup, bos_experiment, "case", "is not BOS"));
  setup.piv = PivSetup{};
  EXPECT_EQ(&case_kind(setup), &piv_case_kind);
  EXPECT_THAT([&] { require_experiment(setup, bos_experiment, "case", "is not BOS"); },
              testing::Throws<DataError>(testing::Property(&DataError::code, ErrorCode::wrong_format)));
}

}  // namespace
}  // namespace gladstone
