#include "studies/uncertain_inputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/case.h"

namespace gladstone {
namespace {

using testing::HasSubstr;

constexpr char const* uncertain = R"(schema = 1
[camera]
pixels = [64, 64]
[geometry]
z_a_mm = 750.0
z_d_mm = { value = 250.0, sigma = 1.5, distribution = "rectangular" }
[medium.field]
kind = "uniform_gradient"
gradient_kg_m4 = [{ value = 10.0, sigma = 0.5, degrees_of_freedom = 9 }, 0.0, 0.0]
[correlate]
window_px = [32, 16]
)";

std::string complaint(std::string const& number) {
  try {
    load_case_setup(SetupDocument::from_text("schema = 1\n[geometry]\nz_d_mm = " + number + "\n", "setup.toml"));
  } catch (SetupError const& error) {
    return error.what();
  }
  return "nothing";
}

TEST(UncertainInputs, AreNumbersToAllThatReadThem) {
  SetupDocument document = SetupDocument::from_text(uncertain, "setup.toml");
  std::vector<UncertainInput> const inputs = take_uncertain_inputs(document);
  CaseSetup const loaded = load_case_setup(std::move(document));
  EXPECT_DOUBLE_EQ(loaded.setup.z_d, 0.25);
  ASSERT_EQ(inputs.size(), 2u);
  EXPECT_EQ(inputs[0].key, "geometry.z_d_mm");
  EXPECT_EQ(inputs[0].value, 250);
  EXPECT_EQ(inputs[0].sigma, 1.5);
  EXPECT_EQ(inputs[0].distribution, InputDistribution::rectangular);
  EXPECT_EQ(inputs[1].key, "medium.field.gradient_kg_m4[0]");
  EXPECT_EQ(inputs[1].degrees_of_freedom, 9);
}

// What a case writes down of its setup says what its numbers are worth, and reads back to the same.
TEST(UncertainInputs, StayInTheResolvedSetup) {
  SetupDocument document = SetupDocument::from_text(uncertain, "setup.toml");
  std::vector<UncertainInput> const inputs = take_uncertain_inputs(document);
  CaseSetup const loaded = load_case_setup(std::move(document));
  SetupDocument written =
      SetupDocument::from_text(with_uncertain_inputs(loaded.document.resolved(), inputs), "again.toml");
  std::vector<UncertainInput> const others = take_uncertain_inputs(written);
  CaseSetup const again = load_case_setup(std::move(written));
  ASSERT_EQ(others.size(), 2u);
  for (UncertainInput const& input : inputs) {
    bool found = false;
    for (UncertainInput const& other : others) {
      found =
          found || (other.key == input.key && other.value == input.value && other.sigma == input.sigma &&
                    other.distribution == input.distribution && other.degrees_of_freedom == input.degrees_of_freedom);
    }
    EXPECT_TRUE(found) << input.key;
  }
  EXPECT_EQ(again.document.resolved(), loaded.document.resolved());
}

TEST(UncertainInputs, AreRefusedAtTheirPlaceWithTheCure) {
  EXPECT_THAT(complaint("{ value = 250.0 }"), testing::AllOf(HasSubstr("setup.toml:3:1: geometry.z_d_mm = "),
                                                             HasSubstr("has a value without its uncertainty; write")));
  EXPECT_THAT(complaint("{ value = 250.0, sigma = -1 }"), HasSubstr("write a number of 0 or more"));
  EXPECT_THAT(complaint("{ value = 250.0, sigma = 1, distribution = \"flat\" }"),
              HasSubstr("use \"normal\" or \"rectangular\""));
  EXPECT_THAT(complaint("{ value = 250.0, sigma = 1, degrees_of_freedom = 0 }"), HasSubstr("a number of 1 or more"));
  EXPECT_THAT(complaint("{ value = 250.0, sigme = 1 }"), HasSubstr("did you mean sigma?"));
  EXPECT_THAT(complaint("{ value = -250.0, sigma = 1 }"), HasSubstr("setup.toml:3:1: "));
  EXPECT_EQ(complaint("{ value = 250.0, sigma = 1 }"), "nothing");
}

}  // namespace
}  // namespace gladstone
