#include "render/base/nearest_name.h"

#include <gtest/gtest.h>

namespace gladstone {
namespace {

TEST(EditDistance, CountsSingleCharacterEdits) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);  // textbook example: two replacements, one insertion
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("abc", ""), 3u);
  EXPECT_EQ(edit_distance("same", "same"), 0u);
  EXPECT_EQ(edit_distance("cmaera", "camera"), 1u);  // adjacent characters swapped
}

TEST(NearestName, IsTheLikelyMeaningOrNothing) {
  EXPECT_EQ(nearest_name("f_nuber", {"focus", "f_number", "file"}), "f_number");
  EXPECT_EQ(nearest_name("focal_length", {"file", "focal_length_mm"}), "focal_length_mm");
  EXPECT_EQ(nearest_name("z_a", {"z_d_mm", "z_a_mm"}), "z_a_mm");  // missing unit suffix
  EXPECT_EQ(nearest_name("BOS", {"piv", "bos"}), "bos");
  EXPECT_EQ(nearest_name("wavelength", {"file", "kind"}), std::nullopt);
  EXPECT_EQ(nearest_name("x", {}), std::nullopt);
  std::vector<std::string> const glasses{"BK10", "BK7", "SF6", "BK7", "BAK1"};
  EXPECT_EQ(nearest_names("BK1", glasses, 5), (std::vector<std::string>{"BK10", "BK7", "BAK1"}));
  EXPECT_EQ(nearest_names("BK1", glasses, 1), (std::vector<std::string>{"BK10"}));
}

// The time of an edit distance is proportional to the product of both lengths: comparing a whole book with a hundred
// keys would take minutes.
TEST(NearestName, OfAVeryLongWordIsNoneAtOnce) {
  std::string const book(std::size_t{16} << 20, 'a');
  std::clock_t const start = std::clock();
  EXPECT_EQ(nearest_name(book, std::vector<std::string>(100, "magnification")), std::nullopt);
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 1);
}

TEST(QuotedList, ReadsAsASentence) {
  EXPECT_EQ(quoted_list({"a"}), "\"a\"");
  EXPECT_EQ(quoted_list({"a", "b", "c"}), "\"a\", \"b\" or \"c\"");
}

}  // namespace
}  // namespace gladstone
