#include "render/base/nearest_name.h"

#include <gtest/gtest.h>

namespace gladstone {
namespace {

TEST(EditDistance, CountsSingleCharacterEdits) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);  // the textbook pair: two replacements, one insertion
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
  EXPECT_EQ(edit_distance("same", "same"), 0u);
  EXPECT_EQ(edit_distance("cmaera", "camera"), 1u);  // neighbours swapped
}

TEST(NearestName, IsTheLikelyMeaningOrNothing) {
  EXPECT_EQ(nearest_name("f_nuber", {"focus", "f_number", "file"}), "f_number");
  EXPECT_EQ(nearest_name("focal_length", {"file", "focal_length_mm"}), "focal_length_mm");
  EXPECT_EQ(nearest_name("z_a", {"z_d_mm", "z_a_mm"}), "z_a_mm");  // the unit forgotten
  EXPECT_EQ(nearest_name("wavelength", {"file", "kind"}), std::nullopt);
  EXPECT_EQ(nearest_name("x", {}), std::nullopt);
}

TEST(QuotedList, ReadsAsASentence) {
  EXPECT_EQ(quoted_list({"a"}), "\"a\"");
  EXPECT_EQ(quoted_list({"a", "b", "c"}), "\"a\", \"b\" or \"c\"");
}

}  // namespace
}  // namespace gladstone
