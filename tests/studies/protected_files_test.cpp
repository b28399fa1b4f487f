#include "studies/commands/protected_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/documented_tables.h"

namespace gladstone {
namespace {

// A row of docs/file-formats.md is "study (`manifest.jsonl`, `cases/`)", the entries by which a folder is recognised,
// followed by the protected files: "these" and others.
TEST(ProtectedFiles, AreThoseOfTheDocumentedTable) {
  auto const rows = test::documented_table("Protected files", "folder");
  std::vector<ProtectedFiles> const all = protected_files();
  ASSERT_EQ(rows.size(), all.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ProtectedFiles const& files = all[i];
    std::vector<std::string> markers = test::names_of(rows[i][0]), names = test::names_of(rows[i][1]);
    for (std::string& marker : markers) {
      if (marker.ends_with('/')) marker.pop_back();
    }
    if (rows[i][1].starts_with("these")) names.insert(names.begin(), markers.begin(), markers.end());
    EXPECT_EQ(rows[i][0].substr(0, rows[i][0].find(" (")), files.what);
    EXPECT_THAT(files.markers, testing::UnorderedElementsAreArray(markers)) << files.what;
    EXPECT_THAT(files.names, testing::UnorderedElementsAreArray(names)) << files.what;
  }
}

}  // namespace
}  // namespace gladstone
