#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/base/error.h"
#include "studies/case/case.h"
#include "studies/design/question.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Reads a design question like the command; line 1 is "schema = 1".
std::optional<DesignQuestion> question_of(std::string const& text) {
  SetupDocument document = SetupDocument::from_text("schema = 1\n" + text, "setup.toml");
  auto question = read_design_question(document);
  load_case_setup(std::move(document));
  return question;
}

template <class... Pieces>
void expect_refused_question(std::string const& text, Pieces const&... pieces) {
  EXPECT_THAT([&] { question_of(text); }, testing::ThrowsMessage<SetupError>(AllOf(HasSubstr(pieces)...))) << text;
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
  EXPECT_DOUBLE_EQ(*question->requirements.z_total_max, 2.4);
  EXPECT_DOUBLE_EQ(question->requirements.field_of_view->y, 0.09);
  EXPECT_FALSE(question->requirements.resolution);
  ASSERT_EQ(question->free.size(), 3u);
  EXPECT_EQ(question->free[0].values, (std::vector<double>{8, 11}));
  EXPECT_DOUBLE_EQ(question->free[1].low, 0.3);
  EXPECT_DOUBLE_EQ(question->free[2].values.back(), 0.2);
}

TEST(DesignQuestion, WithoutRequirementsIsNone) {
  EXPECT_FALSE(question_of("[lens]\nf_number = 8\n"));
  expect_refused_question("[limits]\nz_a_mm = [1, 2]\n", "2:2", "requires [requirements]");
}

TEST(DesignQuestion, MistakesAreToldAtTheirPlaces) {
  auto const with = [](std::string const& old, std::string const& replacement) {
    std::string text = good;
    return text.replace(text.find(old), old.size(), replacement);
  };
  expect_refused_question(with("gradient_min_kg_m4 = 2.0", "gradient_min_kg_m4 = -2.0"), "setup.toml:4:1",
                          "requirements.gradient_min_kg_m4");
  expect_refused_question(with("gradient_min_kg_m4", "gradient_mim_kg_m4"), "setup.toml:4:1",
                          "did you mean \"gradient_min_kg_m4\"?");
  expect_refused_question(with("\"resolution\"", "\"resolutoin\""), "setup.toml:3:1", "did you mean \"resolution\"?");
  expect_refused_question(with("z_a_mm = [300.0, 2000.0]\n", ""), "setup.toml:12:1",
                          "\"geometry.z_a_mm\" has no bounds; add limits.z_a_mm");
  expect_refused_question(with("[300.0, 2000.0]", "[2000.0, 300.0]"), "setup.toml:8:1",
                          "lower limit 2000 exceeds upper limit 300");
  expect_refused_question(with("z_total_max_mm = 2400.0", "z_total_max_mm = 240.0"), "setup.toml:7:1",
                          "conflicts with the other limits", "is at least 400 mm");
  expect_refused_question(with("f_numbers = [8, 11]", "f_numbers = []"), "setup.toml:11:1", "inventory.f_numbers");
  expect_refused_question(with("\"lens.f_number\"", "\"lens.f_nubmer\""), "setup.toml:13:1",
                          "did you mean \"lens.f_number\"?");
  expect_refused_question(with("\"lens.f_number\"", "\"lens.f_number\", \"lens.f_number\""), "setup.toml:13:1",
                          "\"lens.f_number\" is listed twice");
  expect_refused_question(with(", \"lens.f_number\"", ""), "setup.toml:11:1", "lists values of a key that is not free");
  expect_refused_question(with("keys = [\"geometry.z_a_mm\", \"geometry.z_d_mm\", \"lens.f_number\"]", "keys = []"),
                          "setup.toml:13:1", "contains no valid key");
  expect_refused_question(with("[inventory]", "[inventory]\ncameras = [\"nowhere.toml\"]"), "setup.toml:11:1",
                          "there is no file");
  std::string const named = with("f_numbers = [8, 11]", "f_numbers = [8, 11]\nfocal_lengths_mm = [50, \"tele.zmx\"]");
  expect_refused_question(
      std::string(named).replace(named.find("\"lens.f_number\""), 15, "\"lens.f_number\", \"lens.focal_length_mm\""),
      "setup.toml:12:1", "list prescription files as inventory.lenses");
}

}  // namespace
}  // namespace gladstone
