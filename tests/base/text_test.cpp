#include "render/base/text.h"

#include <gtest/gtest.h>

namespace gladstone {
namespace {

TEST(CountText, HasThePluralExceptForOne) {
  EXPECT_EQ(count_text(0, "pair"), "0 pairs");
  EXPECT_EQ(count_text(1, "thread"), "1 thread");
  EXPECT_EQ(count_text(4, "thread"), "4 threads");
}

}  // namespace
}  // namespace gladstone
