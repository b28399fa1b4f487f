#include "render/files/visible_files.h"

#include <gtest/gtest.h>

#include "tests/support/folder_fixture.h"

namespace gladstone {
namespace {

class VisibleFilesTest : public FolderFixture {};

TEST_F(VisibleFilesTest, HaveNamesWithoutALeadingDot) {
  EXPECT_FALSE(contains_visible_files(folder_ / "absent"));
  EXPECT_FALSE(contains_visible_files(folder_));
  write(".hidden", "");
  EXPECT_FALSE(contains_visible_files(folder_));
  write("visible", "");
  EXPECT_TRUE(contains_visible_files(folder_));
}

}  // namespace
}  // namespace gladstone
