#include "studies/case/warning_kinds.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "studies/case/warning_json.h"

namespace gladstone {
namespace {

// Two pairs with the same kind of warning, whose numbers differ; a pair is counted once.
TEST(WarningKinds, AreThoseOfOneCodeAndPlace) {
  WarningKinds kinds;
  kinds.add("a", {WarningCode::excluded, "A_1.tif", "3 pixels"}, "frame");
  kinds.add("a", {WarningCode::excluded, "B_1.tif", "4 pixels"}, "frame");
  kinds.add("a", {WarningCode::excluded, "mask.tif", "5 pixels"}, "mask.tif");
  kinds.add("b", {WarningCode::excluded, "A_2.tif", "6 pixels"}, "frame");
  EXPECT_EQ(kinds.summary(), (Warnings{{WarningCode::excluded, "a: A_1.tif", "3 pixels (and so on, 2 pairs in total)"},
                                       {WarningCode::excluded, "a: mask.tif", "5 pixels"}}));
}

TEST(WarningJson, IsReadBackAndReadsFilesOfEarlierVersions) {
  Warnings const warnings{{WarningCode::exposure, "camera.exposure", "9 pixels"}, {WarningCode::failed, "", "pair 3"}};
  nlohmann::json const json{{"warnings", to_strings(warnings)}, {"warning_records", warnings}};
  EXPECT_EQ(json["warnings"][0], "camera.exposure: 9 pixels");
  EXPECT_EQ(json["warning_records"][0]["code"], "exposure");
  EXPECT_EQ(read_warnings(nlohmann::json::parse(json.dump())), warnings);
  EXPECT_EQ(read_warnings(nlohmann::json{{"warnings", {"lens: narrow"}}}),
            (Warnings{{WarningCode::other, "", "lens: narrow"}}));
  EXPECT_TRUE(read_warnings(nlohmann::json::object()).empty());
}

}  // namespace
}  // namespace gladstone
