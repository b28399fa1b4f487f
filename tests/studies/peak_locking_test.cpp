#include "studies/case/peak_locking.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <regex>

#include "render/base/units.h"
#include "studies/case/case.h"
#include "studies/design/bos_sheet.h"
#include "studies/design/design_point.h"
#include "studies/design/sheet.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

/// Returns the text of the warning of peak locking; empty without one.
template <class Source>
std::string advice_text(Source const& source) {
  auto const warning = locking_advice(source);
  return warning ? warning->text : "";
}

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Particles of 1 um through a lens of 105 mm at 0.75 m: M = 105 / 645, an e^-2 diameter of 1.682 N (1 + M) lambda.
std::string one_lens_setup(std::string const& lens, double pitch_um, std::string const& scattering = "lambert") {
  return "schema = 1\nexperiment = \"piv\"\n[camera]\npixels = [64, 64]\npixel_pitch_um = " + std::to_string(pitch_um) +
         "\n[lens]\nfocal_length_mm = 105.0\n" + lens +
         "\n[geometry]\nz_a_mm = 750.0\n[medium.field]\nkind = \"none\"\n[particles]\nnumber = 100\nvolume_mm = [10.0, "
         "10.0, 1.0]\ndiameter_um = 1.0\nscattering = \"" +
         scattering +
         "\"\n[laser]\nthickness_mm = 1.0\n[flow]\nkind = "
         "\"uniform\"\nvelocity_m_s = [1.0, 0.0, "
         "0.0]\ndt_us = 10.0\n";
}

Setup setup_of(std::string const& text) { return load_case_setup(SetupDocument::from_text(text, "setup.toml")).setup; }

/// Returns the number after a key in a text.
double number_behind(std::string const& text, std::string const& key) {
  std::smatch found;
  EXPECT_TRUE(std::regex_search(text, found, std::regex(key + " = ([0-9.]+)"))) << text;
  return found.empty() ? NAN : std::stod(found[1]);
}

// Particle images of 1.45 px at f/8 have peak locking of 0.06 px, those of 2.6 px 0.002 px (simulations of PIV with
// this correlator). The formula is within a factor of 1.7 of its study of dots, the smallest of which are 0.8 px; its
// extrapolation to particles without size may add as much: within a factor of two.
TEST(PeakLocking, ErrorFallsWithTheDiameterOfTheImage) {
  ImageDiameters const small{0, 1.45, 0}, wide{0, 2.6, 0};
  EXPECT_LT(std::abs(std::log(small.locking_error_px() / 0.06)), std::log(1.7));
  EXPECT_LT(std::abs(std::log(wide.locking_error_px() / 0.002)), std::log(2.0));
}

// 1.682 x 8 x (1 + 105/645) x 0.532 um = 8.326 um over 5.74 um are 1.450 px. The recommended f-number widens the images
// to exactly 2 px, since the PSF is proportional to it; the recommended focus does so within 1 %, by which it changes
// M.
TEST(PeakLocking, RecommendsApertureAndFocus) {
  gladstone::Setup const setup = setup_of(one_lens_setup("f_number = 8.0", 5.742));
  EXPECT_NEAR(expected_images(setup).diameter_px(), 1.45, 1e-3);
  std::string const advice = advice_text(setup);
  EXPECT_THAT(advice, AllOf(HasSubstr("1.45 px"), HasSubstr("2 px")));
  double const factor = expected_images(setup).f_number_factor(2);
  // std::to_string rounds the f-number to 5e-7, and the diameter with it to 5e-7 of 2 px in 11: 1e-7
  EXPECT_NEAR(
      expected_images(setup_of(one_lens_setup("f_number = " + std::to_string(8 * factor), 5.742))).diameter_px(), 2,
      1e-6);
  // three digits, rounded up
  EXPECT_GE(number_behind(advice, "lens.f_number"), 8 * factor);
  EXPECT_LT(number_behind(advice, "lens.f_number"), 8 * factor + 0.1);
  std::string const focus = std::to_string(number_behind(advice, "lens.focus_distance_mm"));
  gladstone::Setup const cured = setup_of(one_lens_setup("f_number = 8.0\nfocus_distance_mm = " + focus, 5.742));
  EXPECT_NEAR(expected_images(cured).diameter_px(), 2, 0.02);
  EXPECT_EQ(advice_text(setup_of(one_lens_setup("f_number = 16.0", 5.742))), "");
  // ideal images are always in focus: only the f-number is a remedy
  std::string const ideal = advice_text(setup_of(one_lens_setup("f_number = 8.0", 5.742, "gaussian")));
  EXPECT_THAT(ideal, AllOf(HasSubstr("lens.f_number"), Not(HasSubstr("focus_distance_mm"))));
}

// A setup changed as recommended causes no warning: f-numbers are rounded up, and 0.5 % are allowed for the other
// remedies.
TEST(PeakLocking, NoWarningAfterAdviceIsApplied) {
  for (double const pitch_um : {5.742, 6.45, 9.0, 10.0, 13.7}) {
    std::string const advice = advice_text(setup_of(one_lens_setup("f_number = 8.0", pitch_um)));
    std::string const stop = std::to_string(number_behind(advice, "lens.f_number"));
    gladstone::Setup const stopped = setup_of(one_lens_setup("f_number = " + stop, pitch_um));
    EXPECT_GE(expected_images(stopped).diameter_px(), 2 - 1e-9) << advice;
    EXPECT_EQ(advice_text(stopped), "") << advice;
    std::string const focus = std::to_string(number_behind(advice, "lens.focus_distance_mm"));
    gladstone::Setup const focused = setup_of(one_lens_setup("f_number = 8.0\nfocus_distance_mm = " + focus, pitch_um));
    EXPECT_NEAR(expected_images(focused).diameter_px(), 2, 0.002) << advice;
    EXPECT_EQ(advice_text(focused), "") << advice;
  }
  std::string const small = "schema = 1\n[target]\ndot_diameter_px = 1.0\n";
  std::string const advice = advice_text(setup_of(small));
  for (auto const& [table, key] : {std::pair("lens", "f_number"), std::pair("lens", "focus_distance_mm")}) {
    std::string const value = std::to_string(number_behind(advice, std::string(table) + '.' + key));
    EXPECT_EQ(advice_text(setup_of(small + '[' + table + "]\n" + key + " = " + value + '\n')), "") << advice;
  }
  std::string const dot = std::to_string(number_behind(advice, "target.dot_diameter_mm"));
  EXPECT_EQ(advice_text(setup_of("schema = 1\n[target]\ndot_diameter_mm = " + dot + '\n')), "") << advice;
}

// The e^-2 diameter of the PSF that is drawn counts. Table 1: 1.10 px (airy, gaussian), 1.595 px (gaussian_first_zero),
// pi times that as printed in Rajendran et al. 2019; zero without a PSF.
TEST(PeakLocking, OfDotsCountsTheSpotThatIsDrawn) {
  auto const advice = [](std::string const& psf) {
    return advice_text(setup_of("schema = 1\n[lens]\npsf = \"" + psf + "\"\n[target]\ndot_diameter_px = 1\n"));
  };
  EXPECT_THAT(advice("airy"), HasSubstr("1.49 px"));
  EXPECT_THAT(advice("gaussian_first_zero"), HasSubstr("1.88 px"));
  EXPECT_EQ(advice("seed_eq8"), "") << "5.01 px";
  EXPECT_THAT(advice("none"), HasSubstr("1.00 px"));
}

// The warning of a setup is one of the warnings of its rendering, once and with its remedies.
TEST(PeakLocking, OfDotsIsAWarningOfTheSetup) {
  auto const warnings = [](std::string const& text) {
    return load_case_setup(SetupDocument::from_text(text, "setup.toml")).warnings;
  };
  EXPECT_THAT(warnings("schema = 1\n[target]\ndot_diameter_px = 1.0\n"),
              testing::ElementsAre(Warns("unsuitable", HasSubstr("lens.f_number = "))));
  EXPECT_THAT(warnings("schema = 1\n"), testing::IsEmpty());
}

// BOS: g = 1 px with a PSF of 1.100 px (Table 1) is 1.487 px wide; a dot of sqrt(4 - 1.1^2) = 1.670 px is a remedy. On
// a sensor that is not in focus the circle of confusion counts, too: a larger f-number is a decreasing remedy.
TEST(PeakLocking, OfDotsCountsDefocusAndNamesTheirSize) {
  std::string const small = "schema = 1\n[target]\ndot_diameter_px = 1.0\n";
  gladstone::Setup const setup = setup_of(small);
  EXPECT_NEAR(expected_images(setup).diameter_px(), 1.487, 1e-3);
  double const px = setup.pixel_size() / unit::millimetre;
  EXPECT_NEAR(number_behind(advice_text(setup), "target.dot_diameter_mm"), 1.670 * px, 1e-3);
  std::string const focus = std::to_string(number_behind(advice_text(setup), "lens.focus_distance_mm"));
  EXPECT_NEAR(expected_images(setup_of(small + "[lens]\nfocus_distance_mm = " + focus + '\n')).diameter_px(), 2, 0.02);
  EXPECT_EQ(advice_text(setup_of("schema = 1\n")), "");
}

// One definition: the dot image of the sheet (F14) is that of the setup, and at the largest f-number (F22) it reaches
// the limit of the recommendation.
TEST(DotImage, IsOneDiameterInSheetSetupAndRecommendation) {
  CaseSetup const loaded = load_case_setup(SetupDocument::from_text("schema = 1\n", "setup.toml"));
  FixedDesignParameters const given = collect_fixed_parameters(loaded);
  DesignPoint<double> bench = make_design_point(loaded.setup, given);
  DesignSheet const sheet = bos_sheet(loaded.setup, bench);
  EXPECT_DOUBLE_EQ(sheet["dot_diameter_px"], bench.dot_image_px());
  EXPECT_NEAR(sheet["dot_diameter_px"],
              std::hypot(loaded.setup.geometric_dot_px(), loaded.setup.spot_e2_diameter_px(),
                         loaded.setup.defocus_diameter_px()),
              1e-12);
  bench.f_number = sheet["f_number_ceiling"];
  EXPECT_NEAR(bench.dot_image_px(), random_error_range.most_image, 1e-9);
}

/// Gaussian dots of an e^-2 diameter, integrated over the pixels, at random places.
Image<double> picture(double diameter) {
  Image<double> image(128, 128);
  std::mt19937 random(7);
  double const scale = 4 / (diameter * std::sqrt(2.0));
  for (int dot = 0; dot < 400; ++dot) {
    double const x = 128.0 * random() / 4294967296.0, y = 128.0 * random() / 4294967296.0;
    for (int row = std::max(0, int(y) - 6); row < std::min(128, int(y) + 7); ++row) {
      for (int column = std::max(0, int(x) - 6); column < std::min(128, int(x) + 7); ++column) {
        auto const share = [scale](double d) { return std::erf((d + 0.5) * scale) - std::erf((d - 0.5) * scale); };
        image(column, row) += 1000 * share(column - x) * share(row - y);
      }
    }
  }
  return image;
}

// Without a setup the width is estimated from the frame: within 10 % of 1.4 px, since the autocorrelation is that of a
// Gaussian, except for the pixels.
TEST(PeakLocking, IsDetectedFromImageAlone) {
  std::string const advice = advice_text(picture(1.4));
  std::smatch found;
  ASSERT_TRUE(std::regex_search(advice, found, std::regex("about ([0-9.]+) px wide"))) << advice;
  EXPECT_NEAR(std::stod(found[1]), 1.4, 0.14);
  EXPECT_EQ(advice_text(picture(2.6)), "");
  EXPECT_EQ(advice_text(Image<double>(64, 64, 5.0)), "") << "no dots at all";
}

}  // namespace
}  // namespace gladstone
