#include <gtest/gtest.h>

#include <map>

#include "studies/case/case.h"
#include "studies/design/bounds.h"
#include "studies/design/question.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

/// Reads a design question like the command; line 1 is "schema = 1".
std::optional<DesignQuestion> question_of(std::string const& text) {
  SetupDocument document = SetupDocument::from_text("schema = 1\n" + text, "setup.toml");
  auto question = read_design_question(document);
  load_case_setup(std::move(document));
  return question;
}

/// Returns "CODE at PLACE" of each error in a design question.
std::string complaint(std::string const& text) {
  return error_of([&] { question_of(text); });
}

constexpr char const* good = R"([requirements]
objective = "resolution"
gradient_min_kg_m4 = 2.0
field_of_view_mm = [120.0, 90.0]
[limits]
z_total_max_mm = 2400.0
z_a_mm = [300.0, 2000.0]
z_d_mm = { values = [100, 200] }
[inventory]
f_numbers = [8, 11]
[free]
keys = ["geometry.z_a_mm", "geometry.z_d_mm", "lens.f_number"]
)";

TEST(DesignQuestion, IsReadInSi) {
  auto const question = question_of(good);
  ASSERT_TRUE(question);
  EXPECT_EQ(question->requirements.objective, Objective::resolution);
  std::map<std::string, double> limits;
  for (Limit const& limit : question->requirements.limits) limits[limit.bound->name] = limit.value;
  EXPECT_EQ(limits.size(), 4u);
  EXPECT_DOUBLE_EQ(limits.at("limits.z_total_max_mm"), 2.4);
  EXPECT_DOUBLE_EQ(limits.at("requirements.field_of_view_mm[1]"), 0.09);
  ASSERT_EQ(question->free.size(), 3u);
  EXPECT_EQ(question->free[0].values, (std::vector<double>{8, 11}));
  EXPECT_DOUBLE_EQ(question->free[1].low, 0.3);
  EXPECT_DOUBLE_EQ(question->free[2].values.back(), 0.2);
}

// A row of the table suffices: every requirement is read at its key, in the unit of its name.
TEST(DesignQuestion, HasEveryRequirementOfTheTable) {
  std::map<std::string, std::string> tables{{"requirements", "objective = \"resolution\"\n"}};
  for (Bound const& bound : requirements())
    if (bound.component() <= 0)
      tables[bound.table()] += bound.key() + (bound.component() < 0 ? " = 2.0\n" : " = [2.0, 2.0]\n");
  std::string text = "[inventory]\nf_numbers = [8]\n[free]\nkeys = [\"lens.f_number\"]\n";
  for (auto const& [table, keys] : tables) text += '[' + table + "]\n" + keys;
  auto const question = question_of(text);
  ASSERT_TRUE(question);
  std::vector<Limit> const& limits = question->requirements.limits;
  ASSERT_EQ(limits.size(), requirements().size());
  for (std::size_t i = 0; i < limits.size(); ++i) {
    EXPECT_EQ(limits[i].bound, &requirements()[i]);
    EXPECT_DOUBLE_EQ(limits[i].value, 2.0 * limits[i].bound->unit) << limits[i].bound->name;
  }
}

TEST(DesignQuestion, WithoutRequirementsIsNone) {
  EXPECT_FALSE(question_of("[lens]\nf_number = 8\n"));
  EXPECT_EQ(complaint("[limits]\nz_a_mm = [1, 2]\n"), "invalid_value at setup.toml:2:2");
}

TEST(DesignQuestion, MistakesAreToldAtTheirPlaces) {
  auto const with = [](std::string const& old, std::string const& replacement) {
    std::string text = good;
    return text.replace(text.find(old), old.size(), replacement);
  };
  EXPECT_EQ(complaint(with("gradient_min_kg_m4 = 2.0", "gradient_min_kg_m4 = -2.0")), "out_of_range at setup.toml:4:1");
  EXPECT_EQ(complaint(with("gradient_min_kg_m4", "gradient_mim_kg_m4")), "unknown_key at setup.toml:4:1");
  EXPECT_EQ(complaint(with("\"resolution\"", "\"resolutoin\"")), "unknown_choice at setup.toml:3:1");
  EXPECT_EQ(complaint(with("z_a_mm = [300.0, 2000.0]\n", "")), "invalid_value at setup.toml:12:1");
  EXPECT_EQ(complaint(with("[300.0, 2000.0]", "[2000.0, 300.0]")), "invalid_value at setup.toml:8:1");
  EXPECT_EQ(complaint(with("z_total_max_mm = 2400.0", "z_total_max_mm = 240.0")), "invalid_value at setup.toml:7:1");
  EXPECT_EQ(complaint(with("f_numbers = [8, 11]", "f_numbers = []")), "wrong_type at setup.toml:11:1");
  EXPECT_EQ(complaint(with("\"lens.f_number\"", "\"lens.f_nubmer\"")),
            "invalid_value at setup.toml:11:1, invalid_value at setup.toml:13:1");
  EXPECT_EQ(complaint(with("\"lens.f_number\"", "\"lens.f_number\", \"lens.f_number\"")),
            "invalid_value at setup.toml:13:1");
  EXPECT_EQ(complaint(with(", \"lens.f_number\"", "")), "invalid_value at setup.toml:11:1");
  EXPECT_EQ(complaint(with("keys = [\"geometry.z_a_mm\", \"geometry.z_d_mm\", \"lens.f_number\"]", "keys = []")),
            "invalid_value at setup.toml:8:1, invalid_value at setup.toml:9:1, invalid_value at setup.toml:11:1, "
            "invalid_value at setup.toml:13:1");
  EXPECT_EQ(complaint(with("[inventory]", "[inventory]\ncameras = [\"nowhere.toml\"]")),
            "invalid_value at setup.toml:11:1");
  std::string const named = with("f_numbers = [8, 11]", "f_numbers = [8, 11]\nfocal_lengths_mm = [50, \"tele.zmx\"]");
  EXPECT_EQ(complaint(std::string(named).replace(named.find("\"lens.f_number\""), 15,
                                                 "\"lens.f_number\", \"lens.focal_length_mm\"")),
            "invalid_value at setup.toml:12:1");
}

}  // namespace
}  // namespace gladstone
