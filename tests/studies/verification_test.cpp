#include "studies/design/verification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "studies/design/predicted_blur.h"
#include "studies/design/sheet.h"
#include "studies/design/verification_text.h"
#include "tests/studies/support/requirement_bounds.h"
#include "tests/studies/support/table1_design.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// A density wave of 8 mm in the set-up of Table 1: cone, dot and window transmit the product of their transfer
// functions (F10 to F12), a closed form. The lattice interpolates linearly between nodes h = 2 px apart, which loses
// (pi h / l)^2 / 2 of a wave of l = 107 px, 0.0017, and the recurrence's 512 points have an error of 0.002.
TEST(PredictedBlur, TransmitsTheProductOfTheTransferFunctions) {
  CaseSetup const loaded = load_case_setup(SetupDocument::from_text(R"(schema = 1
[camera]
pixels = [256, 256]
[medium.field]
kind = "sinusoid"
amplitude_kg_m3 = 0.01
wavelength_mm = 8.0
[correlate]
window_px = [64, 32]
)",
                                                                    "wave"));
  FixedDesignParameters const given = collect_fixed_parameters(loaded);
  DesignPoint<double> const bench = make_design_point(loaded.setup, given);
  double const wavelength = 8e-3, pixel = bench.pixel_at_medium();
  double const cone = cone_transfer(bench.pupil(), bench.z_b(), bench.z_d, given.thickness, wavelength) *
                      disc_transfer(bench.dot_diameter * bench.z_a / bench.z_b(), wavelength);
  double const all = bench.transfer(wavelength);
  EXPECT_LT(all, cone - 0.05);
  double const amplitude = bench.sensitivity() * 0.01 * 2 * pi / wavelength;
  std::vector<Vec2d> places;
  for (int i = 0; i < 16; ++i) places.push_back({40.0 + 11 * i, 128.0});
  PredictedBlur const blur = predicted_blur(loaded.setup, bench, places);
  for (std::size_t i = 0; i < places.size(); ++i) {
    double const x = (places[i].x - 127.5) * pixel;
    double const eq9 = -amplitude * std::cos(2 * pi * x / wavelength);
    EXPECT_NEAR(blur.cone_px[i].x, (cone - 1) * eq9, 0.004 * amplitude);
    EXPECT_NEAR(blur.whole_px[i].x, (all - 1) * eq9, 0.004 * amplitude);
    EXPECT_NEAR(blur.whole_px[i].y, 0, 1e-12);
  }
}

/// The set-up of Table 1 with simulated values equal to the formulas.
VerifiedDesign as_predicted(FixedDesignParameters const& given) {
  DesignPoint<double> const bench = table1_design(given);
  VerifiedDesign verified;
  verified.outcome.branch.given = &given;
  verified.outcome.branch.value = {0.105, 11, 0.75, 0.25, bench.dot_diameter};
  SimulatedDesign& simulated = verified.simulated;
  simulated.columns = simulated.rows = 384;
  simulated.repeats = 2;
  simulated.random_px = {bench.random_error(), 1e-5};
  simulated.predicted_bias_px = 0.010;
  simulated.bias_px = {0.010, 1e-5};
  simulated.magnification = bench.magnification();
  simulated.peak_electrons = {bench.peak_electrons(), 1};
  double const wavelength = resolved_wavelength(bench);
  simulated.resolution = {wavelength, 1e-3 * wavelength};
  double const cone = cone_transfer(bench.pupil(), bench.z_b(), bench.z_d, given.thickness, wavelength) *
                      disc_transfer(bench.dot_diameter * bench.z_a / bench.z_b(), wavelength);
  simulated.waves = {{wavelength, cone, cone, cone, {transfer_at_resolution, 1e-3}}};
  simulated.causes = {{"cone", 0.007, 0.007}, {"window", 0.003, 0.003}, {"refraction", 0, 0}};
  return verified;
}

VerifiedQuantity const& quantity(VerifiedDesign const& verified, std::string const& key) {
  for (VerifiedQuantity const& one : verified.quantities) {
    if (one.key == key) return one;
  }
  throw std::out_of_range(key);
}

TEST(Verification, ExplainsNothingIfSimulationAgrees) {
  FixedDesignParameters const given = table1_given();
  VerifiedDesign verified = as_predicted(given);
  compare_with_formulas(verified, {{required::resolution, 1.0}, {required::uncertainty_max, 1.0}});
  ASSERT_EQ(verified.quantities.size(), 4u);
  for (VerifiedQuantity const& one : verified.quantities) {
    EXPECT_TRUE(one.agrees()) << one.key;
    EXPECT_EQ(one.why, "") << one.key;
  }
  EXPECT_EQ(verified.requirements.size(), 2u);
  EXPECT_TRUE(verified.kept());
}

TEST(Verification, ReportsCauseOfDisagreement) {
  FixedDesignParameters const given = table1_given();
  VerifiedDesign verified = as_predicted(given);
  verified.simulated.bias_px.value = 0.014;
  verified.simulated.causes[2].simulated = 0.004;  // refraction
  verified.simulated.resolution.value *= 0.8;
  verified.simulated.waves[0].measured.value = 0.85;  // the transfer of the window then deviates most
  compare_with_formulas(verified, {});
  EXPECT_THAT(quantity(verified, "bias_px").why, AllOf(HasSubstr("refraction"), HasSubstr("0.004 px")));
  EXPECT_THAT(quantity(verified, "resolution_mm").why, testing::StartsWith("window: "));
  EXPECT_EQ(quantity(verified, "random_px").why, "");
  verified = as_predicted(given);
  verified.simulated.bias_px.value = 0.014;
  verified.simulated.causes[0].simulated = 0.012;
  compare_with_formulas(verified, {});
  EXPECT_THAT(quantity(verified, "bias_px").why,
              AllOf(HasSubstr("cone"), HasSubstr("0.012 px"), HasSubstr("0.007 px")));
}

// A mean of squares that consists of noise only is within its standard error of zero, however far its root appears to
// be.
TEST(Verification, ComparesSquaredBias) {
  FixedDesignParameters const given = table1_given();
  for (auto const& [error2, agrees] : {std::pair{3e-5, true}, {2e-5, false}}) {
    VerifiedDesign verified = as_predicted(given);
    verified.simulated.predicted_bias_px = 4e-4;
    verified.simulated.bias_px = {0.007, std::sqrt(4.9e-5 + error2) - 0.007};  // 4.9e-5: 1.6 or 2.4 standard errors
    compare_with_formulas(verified, {});
    EXPECT_EQ(quantity(verified, "bias_px").agrees(), agrees) << error2;
  }
}

TEST(Verification, OmitsCausesThatDoNotExplain) {
  FixedDesignParameters const given = table1_given();
  VerifiedDesign verified = as_predicted(given);
  verified.simulated.bias_px.value = 0.014;
  verified.simulated.causes[1].simulated = 0.0025;
  compare_with_formulas(verified, {});
  EXPECT_THAT(quantity(verified, "bias_px").why,
              AllOf(HasSubstr("window"), HasSubstr("0.0005 px"), HasSubstr("estimator"), Not(HasSubstr("cone"))));
}

TEST(Verification, KeepsARequirementWithinTwoStandardErrors) {
  FixedDesignParameters const given = table1_given();
  double const wavelength = resolved_wavelength(table1_design(given));  // with a standard error of 0.1 %
  for (auto const& [required, kept] : {std::pair{0.9985 * wavelength, true}, {0.997 * wavelength, false}}) {
    VerifiedDesign verified = as_predicted(given);
    compare_with_formulas(verified, {{required::resolution, required}});
    EXPECT_EQ(verified.kept(), kept);
  }
  // the view must not be smaller
  double const view = 512 * table1_design(given).pixel_at_medium();
  for (auto const& [required, kept] : {std::pair{0.99 * view, true}, {1.01 * view, false}}) {
    VerifiedDesign verified = as_predicted(given);
    compare_with_formulas(verified, {{required::view_width, required}});
    EXPECT_EQ(verified.kept(), kept);
  }
}

TEST(Verification, ReportsRequirementsMissedByAllDesigns) {
  FixedDesignParameters const given = table1_given();
  Verification verification;
  verification.benches.push_back(as_predicted(given));
  compare_with_formulas(verification.benches[0], {{required::resolution, 1e-3}});
  EXPECT_TRUE(verification.any());
  std::string const text = verification_text(verification, {});
  EXPECT_THAT(text, HasSubstr("requirements.resolution_mm = 1"));
  EXPECT_FALSE(verification_json(verification).contains("simulated"));
  EXPECT_FALSE(verification_json(verification)["verification"][0]["kept"]);
}

}  // namespace
}  // namespace gladstone
