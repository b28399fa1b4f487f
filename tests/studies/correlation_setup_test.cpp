#include "studies/case/correlation_setup.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "analysis/uncertainty/uncertainty.h"
#include "render/base/error.h"

namespace gladstone {
namespace {

TEST(CorrelationSettings, DefaultsAreThoseOfTheTypeAndAreWrittenOut) {
  SetupDocument document = SetupDocument::from_text("", "case.toml");
  CorrelationSettings const read = read_correlation_settings(document.root().table("correlate"));
  EXPECT_FALSE(document.has_problems());
  EXPECT_EQ(read.window_px, (std::vector<int>{64, 32, 24, 20}));
  EXPECT_EQ(read.overlap, 0.6);
  EXPECT_EQ(read.method, "scc");
  EXPECT_FALSE(read.max_displacement_px);
  EXPECT_EQ(read.trusted_peak_ratio, 2.0);
  EXPECT_NE(document.resolved().find("max_displacement_px = \"none\""), std::string::npos);
  EXPECT_NE(document.resolved().find("window_px"), std::string::npos);
}

TEST(CorrelationSettings, ReadsEveryKey) {
  SetupDocument document = SetupDocument::from_text(
      "[correlate]\nwindow_px = [48, 24]\noverlap = 0.75\nmethod = \"scc\"\nsubpixel = \"gauss3\"\n"
      "weighting = \"uniform\"\ndeformation = \"cubic\"\nfinal_passes = 2\nsteep_passes = 3\nmedian_threshold = 3\n"
      "median_epsilon_px = 0.3\ndisplacement_threshold = 2.5\nmax_displacement_px = 7.5\ntrusted_peak_ratio = 3\n"
      "least_peak_ratio = 1.2\nleast_correlation = 0.4\nuncertainty = \"image_matching\"\nreplace = false\n",
      "case.toml");
  CorrelationSettings const read = read_correlation_settings(document.root().table("correlate"));
  document.finish();
  EXPECT_EQ(read.window_px, (std::vector<int>{48, 24}));
  EXPECT_EQ(read.overlap, 0.75);
  EXPECT_EQ(read.weighting, "uniform");
  EXPECT_EQ(read.deformation, "cubic");
  EXPECT_EQ(read.final_passes, 2);
  EXPECT_EQ(read.steep_passes, 3);
  EXPECT_EQ(read.median_threshold, 3.0);
  EXPECT_EQ(read.median_epsilon_px, 0.3);
  EXPECT_EQ(read.displacement_threshold, 2.5);
  EXPECT_EQ(read.least_peak_ratio, 1.2);
  EXPECT_EQ(read.least_correlation, 0.4);
  EXPECT_FALSE(read.replace);
  EXPECT_EQ(read.uncertainty, "image_matching");
  EXPECT_EQ(read.max_displacement_px, 7.5);
  EXPECT_EQ(read.trusted_peak_ratio, 3.0);
}

TEST(CorrelationSettings, HaveWordsForNoLimit) {
  SetupDocument document = SetupDocument::from_text(
      "[correlate]\nmax_displacement_px = \"none\"\ntrusted_peak_ratio = \"none\"\n", "case.toml");
  CorrelationSettings const read = read_correlation_settings(document.root().table("correlate"));
  document.finish();
  EXPECT_FALSE(read.max_displacement_px);
  EXPECT_FALSE(read.trusted_peak_ratio);
}

TEST(CorrelationSettings, RefusesUnknownNamesAndWhatCannotBe) {
  struct Wrong {
    std::string text;
    ErrorCode code;
    std::string value;  ///< name or limit in the message
  };
  for (auto const& [text, code, value] : {Wrong{"method = \"rcp\"", ErrorCode::unknown_choice, "\"rpc\""},
                                          Wrong{"method = \"rcp\"", ErrorCode::unknown_choice, "\"zncc\""},
                                          Wrong{"subpixel = \"gauss\"", ErrorCode::unknown_choice, "\"gauss2d\""},
                                          Wrong{"least_peak_ratio = 0.5", ErrorCode::out_of_range, " 1"},
                                          Wrong{"least_correlation = 2", ErrorCode::out_of_range, " 1"},
                                          Wrong{"window_px = [33]", ErrorCode::invalid_value, "window_px"},
                                          Wrong{"window_px = [16, 32]", ErrorCode::invalid_value, "window_px"},
                                          Wrong{"overlap = 0.99", ErrorCode::out_of_range, "overlap"},
                                          Wrong{"max_displacement_px = 0", ErrorCode::out_of_range, "512"},
                                          Wrong{"max_displacement_px = -3", ErrorCode::out_of_range, "512"},
                                          Wrong{"max_displacement_px = 512.5", ErrorCode::out_of_range, "512"},
                                          Wrong{"max_displacement_px = nan", ErrorCode::out_of_range, "nan"},
                                          Wrong{"max_displacement_px = inf", ErrorCode::out_of_range, "inf"},
                                          Wrong{"max_displacement_px = \"all\"", ErrorCode::unknown_choice, "\"none\""},
                                          Wrong{"max_displacement_px = true", ErrorCode::wrong_type, "\"none\""},
                                          Wrong{"trusted_peak_ratio = 0.9", ErrorCode::out_of_range, " 1"}}) {
    SetupDocument document = SetupDocument::from_text("[correlate]\n" + text + "\n", "case.toml");
    read_correlation_settings(document.root().table("correlate"));
    try {
      document.finish();
      ADD_FAILURE() << text;
    } catch (SetupError const& error) {
      ASSERT_EQ(error.problems().size(), 1u) << text;
      EXPECT_EQ(error.problems()[0].code, code) << text;
      EXPECT_NE(error.problems()[0].message.find(value), std::string::npos) << error.problems()[0].message;
      EXPECT_EQ(error.problems()[0].where.substr(0, 12), "case.toml:2:") << error.problems()[0].where;
    }
  }
}

TEST(UncertaintySettings, KnowTheMethodsOfTheTable) {
  for (std::string const& method : uncertainty_methods()) {
    SetupDocument document = SetupDocument::from_text("[correlate]\nuncertainty = \"" + method + "\"\n", "case.toml");
    EXPECT_EQ(read_correlation_settings(document.root().table("correlate")).uncertainty, method);
    EXPECT_FALSE(document.has_problems());
  }
}

}  // namespace
}  // namespace gladstone
