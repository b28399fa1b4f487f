#include "studies/case/uncertain_inputs.h"

#include <gtest/gtest.h>

#include <regex>

#include "studies/case/case.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

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
  return error_of([&] {
    load_case_setup(SetupDocument::from_text("schema = 1\n[geometry]\nz_d_mm = " + number + "\n", "setup.toml"));
  });
}

TEST(UncertainInputs, AreNumbersToAllThatReadThem) {
  SetupDocument document = SetupDocument::from_text(uncertain, "setup.toml");
  std::vector<UncertainInput> const inputs = extract_uncertain_inputs(document);
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

// The setup that a case writes contains its uncertainties and is read back unchanged.
TEST(UncertainInputs, StayInTheResolvedSetup) {
  SetupDocument document = SetupDocument::from_text(uncertain, "setup.toml");
  std::vector<UncertainInput> const inputs = extract_uncertain_inputs(document);
  CaseSetup const loaded = load_case_setup(std::move(document));
  SetupDocument written =
      SetupDocument::from_text(insert_uncertain_inputs(loaded.document.resolved(), inputs), "again.toml");
  std::vector<UncertainInput> const others = extract_uncertain_inputs(written);
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
  EXPECT_EQ(complaint("{ value = 250.0 }"), "invalid_value at setup.toml:3:1");
  EXPECT_EQ(complaint("{ value = 250.0, sigma = -1 }"), "invalid_value at setup.toml:3:1");
  EXPECT_EQ(complaint("{ value = 250.0, sigma = 1, distribution = \"flat\" }"), "invalid_value at setup.toml:3:1");
  EXPECT_EQ(complaint("{ value = 250.0, sigma = 1, degrees_of_freedom = 0 }"), "invalid_value at setup.toml:3:1");
  EXPECT_EQ(complaint("{ value = 250.0, sigme = 1 }"),
            "invalid_value at setup.toml:3:1, invalid_value at setup.toml:3:1");
  EXPECT_EQ(complaint("{ value = -250.0, sigma = 1 }"), "out_of_range at setup.toml:3:1");
  EXPECT_EQ(complaint("{ value = 250.0, sigma = 1 }"), "");
}

constexpr char const* correlated = R"(schema = 1
[camera]
pixels = [64, 64]
[lens]
focal_length_mm = { value = 105.0, sigma = 0.5 }
[geometry]
z_a_mm = { value = 750.0, sigma = 1.0 }
z_d_mm = { value = 250.0, sigma = 1.5 }
[medium]
thickness_mm = { value = 10.0, sigma = 0.1, distribution = "rectangular" }
[correlate]
window_px = [32, 16]
)";

std::string correlation_complaint(std::string const& tables) {
  return error_of([&] { load_case_setup(SetupDocument::from_text(std::string(correlated) + tables, "setup.toml")); });
}

std::string pair_of(std::string const& keys, std::string const& coefficient) {
  return "[[correlations]]\nkeys = " + keys + "\ncoefficient = " + coefficient + '\n';
}

constexpr char const* both_distances = R"(["geometry.z_a_mm", "geometry.z_d_mm"])";

// A misplaced ruler makes one distance longer and the other one shorter.
TEST(UncertainInputs, AreCorrelatedInPairsAndStaySo) {
  std::string const text = correlated + pair_of(both_distances, "-0.8");
  SetupDocument document = SetupDocument::from_text(text, "setup.toml");
  std::vector<UncertainInput> const inputs = extract_uncertain_inputs(document);
  ASSERT_EQ(inputs.size(), 4u);
  for (UncertainInput const& input : inputs) {
    bool const distance = input.key.starts_with("geometry.");
    ASSERT_EQ(input.correlations.size(), distance ? 1u : 0u) << input.key;
    if (!distance) continue;
    EXPECT_EQ(input.correlations[0].with, input.key == "geometry.z_a_mm" ? "geometry.z_d_mm" : "geometry.z_a_mm");
    EXPECT_EQ(input.correlations[0].coefficient, -0.8);
  }
  CaseSetup const loaded = load_case_setup(std::move(document));
  SetupDocument written =
      SetupDocument::from_text(insert_uncertain_inputs(loaded.document.resolved(), inputs), "again.toml");
  for (UncertainInput const& again : extract_uncertain_inputs(written)) {
    EXPECT_EQ(again.correlations.size(), again.key.starts_with("geometry.") ? 1u : 0u) << again.key;
  }
  load_case_setup(std::move(written));
  EXPECT_EQ(correlation_complaint(pair_of(both_distances, "-0.8")), "");
}

TEST(UncertainInputs, AreCorrelatedAsNumbersCanBe) {
  EXPECT_EQ(correlation_complaint(pair_of(both_distances, "1.2")), "invalid_value at setup.toml:15:1");
  EXPECT_EQ(correlation_complaint("[[correlations]]\nkeys = " + std::string(both_distances) + '\n'),
            "invalid_value at setup.toml:13:1");
  EXPECT_EQ(correlation_complaint(pair_of(R"(["geometry.z_a_mm"])", "0.5")), "invalid_value at setup.toml:14:1");
  EXPECT_EQ(correlation_complaint(pair_of(R"(["geometry.z_a_mm", "geometry.z_a_mm"])", "0.5")),
            "invalid_value at setup.toml:14:1");
  EXPECT_EQ(correlation_complaint(pair_of(R"(["geometry.z_a_mm", "geometry.z_c_mm"])", "0.5")),
            "invalid_value at setup.toml:14:1");
  EXPECT_EQ(correlation_complaint(pair_of(R"(["geometry.z_a_mm", "medium.thickness_mm"])", "0.5")),
            "invalid_value at setup.toml:14:1");
  EXPECT_EQ(correlation_complaint(pair_of(both_distances, "0.5\nsigma = 1")), "invalid_value at setup.toml:16:1");
  EXPECT_EQ(correlation_complaint(pair_of(both_distances, "0.5") + pair_of(both_distances, "0.5")),
            "invalid_value at setup.toml:17:1");
  // a value that is not a number is reported once, at its place
  std::string const bad = std::regex_replace(std::string(correlated), std::regex("z_d_mm = \\{ value = [0-9.]+"),
                                             "z_d_mm = { value = \"far\"");
  ASSERT_NE(bad, correlated);
  EXPECT_EQ(
      error_of([&] { load_case_setup(SetupDocument::from_text(bad + pair_of(both_distances, "0.5"), "setup.toml")); }),
      "wrong_type at setup.toml:8:1");
  // two inputs correlated with a third one cannot be anticorrelated: the determinant is 1 - 3 (0.9)^2 - 2 (0.9)^3 < 0
  std::string const with_lens = pair_of(R"(["lens.focal_length_mm", "geometry.z_a_mm"])", "0.9") +
                                pair_of(R"(["lens.focal_length_mm", "geometry.z_d_mm"])", "0.9");
  EXPECT_EQ(correlation_complaint(with_lens + pair_of(both_distances, "-0.9")), "invalid_value at setup.toml:21:1");
  EXPECT_EQ(correlation_complaint(with_lens + pair_of(both_distances, "0.9")), "");
  // coefficients may be impossible as long as some pairs are missing: 1, 1 and none
  std::string const all_one = pair_of(R"(["lens.focal_length_mm", "geometry.z_a_mm"])", "1") +
                              pair_of(R"(["lens.focal_length_mm", "geometry.z_d_mm"])", "1");
  EXPECT_EQ(correlation_complaint(all_one), "invalid_value at setup.toml:18:1");
  EXPECT_EQ(correlation_complaint(all_one + pair_of(both_distances, "1")), "");
}

}  // namespace
}  // namespace gladstone
