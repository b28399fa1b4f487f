#include "studies/sweep/case_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/base/error.h"
#include "studies/sweep/run.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(CaseList, JoinsNeighbours) {
  EXPECT_EQ(case_list({5}), "5");
  EXPECT_EQ(case_list({0, 1, 2, 3}), "0-3");
  EXPECT_EQ(case_list({0, 2, 3, 7, 9, 10, 11}), "0,2-3,7,9-11");
}

TEST(CaseList, ReadsWhatItWrites) {
  for (std::vector<std::size_t> const& cases :
       {std::vector<std::size_t>{7}, {0, 1, 2, 3}, {0, 2, 3, 7, 9, 10, 11}, {98, 99}}) {
    EXPECT_EQ(parse_case_list(case_list(cases), 100), cases);
  }
}

TEST(CaseList, OrderAndRepetitionDoNotMatter) {
  EXPECT_THAT(parse_case_list("7,0-2,1-3", 8), ElementsAre(0, 1, 2, 3, 7));
}

TEST(CaseList, WhatIsNoListIsRefused) {
  for (char const* text : {"", "a", "1,", ",1", "3-1", "-1", "1-", "1 2", "1.5", "99999999999999999999"}) {
    EXPECT_THROW(parse_case_list(text, 100), DataError) << text;
  }
}

TEST(CaseList, CasesBeyondTheStudyAreRefusedWithItsSize) {
  EXPECT_EQ(error_of([] { parse_case_list("2-10", 10); }), "arguments at --case");
}

TEST(CaseSelection, TakesAPieceOfTheListThatIsNamed) {
  std::vector<ManifestCase> const cases(10);
  EXPECT_EQ(selected_cases(cases.size(), {}).size(), 10u);
  EXPECT_THAT(selected_cases(cases.size(), {std::nullopt, 1, 3}), ElementsAre(3, 4, 5));
  EXPECT_THAT(selected_cases(cases.size(), {"0-3,7"}), ElementsAre(0, 1, 2, 3, 7));
  EXPECT_THAT(selected_cases(cases.size(), {"0-3,7", 0, 2}), ElementsAre(0, 1));
  EXPECT_THAT(selected_cases(cases.size(), {"0-3,7", 1, 2}), ElementsAre(2, 3, 7));
  EXPECT_THROW(selected_cases(cases.size(), {""}), DataError);
}

}  // namespace
}  // namespace gladstone
