#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>

#include "studies/sweep/results.h"

namespace gladstone {

/// Expects two results to be equal to the last bit, including NaN, except for the times.
inline void expect_same(CaseResult const& one, CaseResult const& other) {
  EXPECT_EQ(one.status, other.status);
  EXPECT_EQ(one.error, other.error);
  EXPECT_EQ(one.warnings, other.warnings);
  ASSERT_EQ(one.measures.size(), other.measures.size());
  for (std::size_t i = 0; i < one.measures.size(); ++i) {
    EXPECT_EQ(one.measures[i].first, other.measures[i].first);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(one.measures[i].second),
              std::bit_cast<std::uint64_t>(other.measures[i].second))
        << one.measures[i].first << " of case " << one.index;
  }
}

}  // namespace gladstone
