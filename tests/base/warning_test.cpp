#include "render/base/warning.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace gladstone {
namespace {

TEST(WarningCodes, HaveNamesThatLeadBackToThem) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(WarningCode::other); ++i) {
    auto const code = static_cast<WarningCode>(i);
    EXPECT_EQ(find_warning_code(warning_code_name(code)), code);
    names.insert(warning_code_name(code));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(WarningCode::other) + 1);
  EXPECT_EQ(warning_code_name(WarningCode::low_accuracy), "low_accuracy");
  EXPECT_EQ(find_warning_code("later_than_this_version"), WarningCode::other);
}

TEST(Warnings, BeginWithTheirPlace) {
  Warning const warning{WarningCode::ignored, "lens.zmx:12", "is not used"};
  EXPECT_EQ(to_string(warning), "lens.zmx:12: is not used");
  EXPECT_EQ(to_string(at_place("pair 3", warning)), "pair 3: lens.zmx:12: is not used");
  EXPECT_EQ(to_string(at_place("pair 3", {WarningCode::ignored, "", "is not used"})), "pair 3: is not used");
}

}  // namespace
}  // namespace gladstone
