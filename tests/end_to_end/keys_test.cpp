// `gladstone keys` prints the tables of docs/reference/setup.md. The readers of a setup accept exactly the keys of
// these tables, with the documented defaults and values.
#include <set>

#include "studies/commands/setup_keys.h"
#include "studies/sweep/unit_ending.h"
#include "tests/end_to_end/support/program_fixture.h"
#include "tests/support/reader_keys.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

constexpr char const* design_problem = R"(experiment = "bos"
[requirements]
objective = "gradient_min"
[free]
keys = ["geometry.z_a_mm", "geometry.z_d_mm", "lens.f_number", "lens.focal_length_mm", "target.dot_diameter_mm"]
)";

/// Tables that are not read by the readers of a rendered setup.
std::set<std::string> const design_tables{"[requirements]", "[limits]", "[inventory]", "[free]"};

bool is_of_setup(SetupKeyTable const& table) {
  return table.kinds != std::vector<std::string>{"study"} && table.heading != "[[correlations]]";
}

std::string without_brackets(std::string text) {
  std::erase_if(text, [](char c) { return c == '[' || c == ']'; });
  return text;
}

std::string experiment_of(SetupKeyTable const& table) {
  for (std::string const& kind : table.kinds)
    if (kind == "bos" || kind == "piv" || kind == "calibration") return kind;
  return "bos";
}

/// Returns the smallest setups in which a table is read: one for each alternative of its condition.
std::vector<std::string> setups_with(SetupKeyTable const& table) {
  if (design_tables.contains(table.heading)) return {design_problem};
  std::string const start = "experiment = \"" + experiment_of(table) + "\"\n", name = without_brackets(table.heading);
  if (name.empty()) return {start};
  if (name == "correlate.preprocess.frame")
    return {start + "[correlate.preprocess]\nkind = \"background\"\nframe = {}\n"};
  std::string const head = start + '[' + name + "]\n";
  if (table.condition.empty()) return {head};
  std::string const key = table.condition.substr(0, table.condition.find(" = ") + 3);
  std::vector<std::string> setups;
  std::string values = table.condition.substr(key.size()) + " or ";
  for (std::size_t end = values.find(" or "); end != std::string::npos; end = values.find(" or ")) {
    setups.push_back(head + key + values.substr(0, end) + '\n');
    values.erase(0, end + 4);
  }
  return setups;
}

TEST(DocumentedKeys, AreReadFromTheirPage) {
  auto const tables = parse_key_tables(
      "# Page\n\n## Text\n\n| `no_key` | | | | |\n\n## `[[window]]`, `kind = \"a\"` or `\"b\"`\n\nKinds: `bos`, "
      "`piv`.\n\n"
      "| key | unit | default | values | meaning |\n|---|---|---|---|---|\n"
      "| `tilt_deg` | deg | `[0.0, 0.0]` | 2 numbers | see [the page](page.md#a) and `glass` |\n"
      "| `file` | | required | file | a file |\n");
  ASSERT_EQ(tables.size(), 1u);
  EXPECT_EQ(tables[0].heading, "[[window]]");
  EXPECT_EQ(tables[0].condition, "kind = \"a\" or \"b\"");
  EXPECT_EQ(tables[0].kinds, (std::vector<std::string>{"bos", "piv"}));
  ASSERT_EQ(tables[0].keys.size(), 2u);
  SetupKey const& tilt = tables[0].keys[0];
  EXPECT_EQ(tilt.path, "window.tilt_deg");
  EXPECT_EQ(tilt.unit, "deg");
  EXPECT_EQ(tilt.default_value, "[0.0, 0.0]");
  EXPECT_EQ(tilt.meaning, "see the page and glass");
  EXPECT_FALSE(tilt.is_required());
  EXPECT_TRUE(tables[0].keys[1].is_required());
  EXPECT_EQ(tables[0].keys[1].default_value, "");
}

// Every key that a reader requests, in the smallest setup with each table, is in the page.
TEST(DocumentedKeys, IncludeEveryKeyOfTheReaders) {
  std::set<std::string> documented;
  for (SetupKeyTable const& table : setup_key_tables()) {
    documented.insert(without_brackets(table.heading));
    for (SetupKey const& key : table.keys) documented.insert(key.path);
  }
  for (SetupKeyTable const& table : setup_key_tables()) {
    if (!is_of_setup(table)) continue;
    for (std::string const& setup : setups_with(table)) {
      test::RequestedKeys const read = test::requested_keys(setup);
      for (auto const& [path, value] : read.values) {
        if (path.starts_with("medium.second_field")) continue;  // has the keys of medium.field
        EXPECT_TRUE(documented.contains(path) || read.looked_for.contains(path)) << path << " is read from\n" << setup;
      }
    }
  }
  for (ChoiceKey const& key : choice_keys) {
    EXPECT_TRUE(documented.contains(std::string("limits.") + key.limit)) << key.limit;
    if (key.inventory) {
      EXPECT_TRUE(documented.contains(std::string("inventory.") + key.inventory)) << key.inventory;
    }
  }
}

// Every key of the page is requested in the smallest setup with its table. To write the documented default changes
// nothing; a documented required key is reported as missing.
TEST(DocumentedKeys, HaveTheDefaultsOfTheReaders) {
  for (SetupKeyTable const& table : setup_key_tables()) {
    if (!is_of_setup(table) || design_tables.contains(table.heading)) continue;
    for (std::string const& setup : setups_with(table)) {
      test::RequestedKeys const read = test::requested_keys(setup);
      for (SetupKey const& key : table.keys) {
        auto const found = read.values.find(key.path);
        ASSERT_NE(found, read.values.end()) << key.path << " is not read from\n" << setup;
        EXPECT_EQ(key.is_required(), read.requires_key(key.path)) << key.path << " in\n" << setup;
        if (key.default_words == "none") {
          EXPECT_EQ(found->second, "") << key.path << " has a default";
        }
        if (key.default_value.empty()) continue;
        if (key.name() == "experiment") continue;
        std::string const given = setup + key.name() + " = " + key.default_value + '\n';
        EXPECT_EQ(test::requested_keys(given).values[key.path], found->second) << given;
      }
    }
  }
}

// The messages of the readers about wrong values state the documented words and limits.
TEST(DocumentedKeys, HaveTheValuesOfTheReaders) {
  // Keys that the readers refuse without another key, or whose values are not checked.
  std::set<std::string> const not_probed{"camera.background.glare_e", "geometry.z_front_mm", "particles.viscosity_pa_s",
                                         "window.cameras", "element.cameras"};
  for (SetupKeyTable const& table : setup_key_tables()) {
    if (!is_of_setup(table)) continue;
    for (std::string const& setup : setups_with(table)) {
      for (SetupKey const& key : table.keys) {
        EXPECT_NE(key.values, "") << key.path;
        if (not_probed.contains(key.path)) continue;
        std::string allowed = test::allowed_values(setup, key.path);
        std::erase(allowed, '`');
        bool const is_file = allowed == "text" && key.values == "file";
        if (!is_file) {
          EXPECT_EQ(key.values, allowed) << key.path << " in\n" << setup;
        }
      }
    }
  }
}

TEST(DocumentedKeys, HaveTheUnitsOfTheirNames) {
  for (SetupKeyTable const& table : setup_key_tables()) {
    for (SetupKey const& key : table.keys) {
      auto const ending = unit_ending(key.path);
      if (ending) {
        EXPECT_EQ(key.unit, ending->unit) << key.path;
      }
      EXPECT_FALSE(key.meaning.empty()) << key.path;
    }
  }
}

class Keys : public ProgramFixture {};

TEST_F(Keys, AreListedWithUnitDefaultAndValues) {
  auto const keys = json_of({"keys", "lens.f_number"}).at("keys");
  ASSERT_EQ(keys.size(), 1u);
  EXPECT_EQ(keys[0].at("key"), "lens.f_number");
  EXPECT_EQ(keys[0].at("unit"), "1");
  EXPECT_EQ(keys[0].at("default"), "11.0");
  EXPECT_EQ(keys[0].at("required"), false);
  EXPECT_EQ(keys[0].at("values"), "> 0");
  EXPECT_NE(keys[0].at("meaning"), "");
  std::string const text = succeed({"keys", "lens.f_number"});
  for (char const* piece : {"lens.f_number", "[1]", "11.0", "> 0"}) EXPECT_THAT(text, HasSubstr(piece));
}

TEST_F(Keys, AreSelectedByPartOrWildcards) {
  std::size_t count = 0;
  for (SetupKeyTable const& table : setup_key_tables()) count += table.keys.size();
  EXPECT_EQ(json_of({"keys"}).at("keys").size(), count);
  for (auto const& key : json_of({"keys", "pitch"}).at("keys")) {
    EXPECT_THAT(key.at("key").get<std::string>(), HasSubstr("pitch"));
  }
  auto const in_um = json_of({"keys", "camera.*_um"}).at("keys");
  EXPECT_EQ(in_um.size(), 5u) << "pixel pitch, and four lengths of the lenslets";
  auto const shock = json_of({"keys", "medium.field.mach"}).at("keys");
  EXPECT_EQ(shock.at(0).at("condition"), "kind = \"normal_shock\"");
  EXPECT_EQ(shock.at(0).at("default"), nullptr);
  EXPECT_EQ(shock.at(0).at("required"), true);
}

TEST_F(Keys, OfAnUnknownNameSuggestTheNearest) {
  for (char const* misspelt : {"lens.focal_lenght_mm", "focal_lenght_mm", "focal_lengh"}) {
    Outcome const outcome = gladstone({"keys", misspelt});
    EXPECT_EQ(outcome.exit_code, 1) << misspelt;
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, HasSubstr("lens.focal_length_mm"));
  }
  Outcome const json = gladstone({"keys", "lens.focal_lenght_mm", "--json"});
  EXPECT_EQ(json.exit_code, 1);
  EXPECT_EQ(nlohmann::json::parse(json.out).at("similar").at(0), "lens.focal_length_mm");
  EXPECT_EQ(nlohmann::json::parse(gladstone({"keys", "zzzzzzzzzzzz", "--json"}).out).at("similar").size(), 0u);
}

}  // namespace
}  // namespace gladstone::end_to_end
