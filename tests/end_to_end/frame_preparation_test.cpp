#include "render/files/source_files.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MaskedFrames : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    ASSERT_EQ(gladstone({"render", "setup.toml", "-o", "case"}).exit_code, 0);
  }
  Outcome correlate(std::string const& tables) const {
    write("config.toml", "[correlate]\nwindow_px = [16]\n" + tables);
    return gladstone({"correlate", "case", "--config", "config.toml", "-o", "v.h5", "--json"});
  }
};

// A file for --config may contain every table of a setup, and so may the case's own setup, which --set changes.
TEST_F(MaskedFrames, AreCorrelatedAsAnyWholeSetupSays) {
  std::string const setup = with(with(small_setup, "z_d_mm = 250.0", "z_d_mm = { value = 250.0, sigma = 1.0 }"),
                                 "z_a_mm = 750.0", "z_a_mm = { value = 750.0, sigma = 2.0 }") +
                            R"(
[[window]]
side = "target"
glass = "N-BK7"
thickness_mm = 20
position_mm = [0.0, 0.0, -100.0]
[light]
radiance_w_m2_sr = 8000.0
exposure_us = 20.0
[[correlations]]
keys = ["geometry.z_a_mm", "geometry.z_d_mm"]
coefficient = -0.8
[requirements]
objective = "gradient_min"
resolution_mm = 4.0
[limits]
z_a_mm = [300.0, 2000.0]
[inventory]
f_numbers = [8, 16]
[free]
keys = ["geometry.z_a_mm"]
)";
  write("whole.toml", setup);
  succeed({"correlate", "case/reference.tif", "case/flow.tif", "-o", "v.csv", "--config", "whole.toml"});
  write("windowed.toml", with(setup, "[light]\nradiance_w_m2_sr = 8000.0\nexposure_us = 20.0\n", ""));
  render("windowed", {}, "windowed.toml");
  succeed({"correlate", "windowed", "--set", "correlate.overlap=0.75"});
  succeed({"correlate", "case/reference.tif", "case/flow.tif", "-o", "v.csv", "--config", "windowed/setup.toml"});
  write("misspelt.toml", with(setup, "[correlate]", "[corelate]"));
  expect_error({"correlate", "case/reference.tif", "case/flow.tif", "-o", "w.csv", "--config", "misspelt.toml"}, 2,
               "unknown_key at misspelt.toml:" + place_of(read("misspelt.toml"), "corelate"), {"[correlate]"});
}

// 64 px with the left half masked: windows of 16 px of which at least half is in it have status 2.
TEST_F(MaskedFrames, AreRecordedWithTheVectors) {
  Image<std::uint16_t> mask(64, 64, 1);
  for (int j = 0; j < 64; ++j) std::fill_n(mask.data() + std::ptrdiff_t{64} * j, 32, std::uint16_t{0});
  write_tiff(in("mask.tif").string(), mask, {});
  Outcome const outcome = correlate(
      "[[correlate.mask]]\nkind = \"image\"\nfile = \"mask.tif\"\n"
      "[[correlate.preprocess]]\nkind = \"intensity_cap\"\ndeviations = 4\n");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  Hdf5Reader const file(in("v.h5").string());
  EXPECT_EQ(file.attribute("preparation_1_sha256"), pixel_sha256(in("mask.tif").string()));
  EXPECT_THAT(file.attribute("setup"),
              AllOf(HasSubstr("intensity_cap"), HasSubstr("deviations = 4"), HasSubstr("mask.tif")));
  auto const x = file.read("/x_px"), status = file.read("/status");
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(status[i] == 2.0, x[i] + 0.5 < 32.0) << x[i];
}

// A case does not depend on the masks of its setup, but its vectors do: a mask may change between render and correlate,
// but not between correlate and compare, which repeats the measurement.
TEST_F(MaskedFrames, MayHaveAnotherMaskThanWhenTheyWereRendered) {
  auto const write_mask = [&](int columns) {
    Image<std::uint16_t> mask(64, 64, 1);
    for (int j = 0; j < 64; ++j) std::fill_n(mask.data() + std::ptrdiff_t{64} * j, columns, std::uint16_t{0});
    write_tiff(in("mask.tif").string(), mask, {});
  };
  write("masked.toml", small_setup + std::string("[[correlate.mask]]\nkind = \"image\"\nfile = \"mask.tif\"\n"));
  write_mask(20);
  ASSERT_EQ(gladstone({"render", "masked.toml", "-o", "masked"}).exit_code, 0);
  write_mask(32);
  ASSERT_EQ(gladstone({"correlate", "masked"}).exit_code, 0);
  Outcome const compared = gladstone({"compare", "masked", "--no-figures"});
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  write_mask(10);
  Outcome const changed = gladstone({"compare", "masked", "--no-figures", "--json"});
  EXPECT_EQ(changed.exit_code, 2);
  expect_error_in(changed, "changed at mask.tif", {"gladstone correlate"});
}

TEST_F(MaskedFrames, WithNothingLeftAreNoMeasurement) {
  Outcome const outcome = correlate("[[correlate.mask]]\nkind = \"intensity\"\nbelow_dn = 1e9\n");
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  auto const json = nlohmann::json::parse(outcome.out);
  EXPECT_THAT(warnings_in(json), testing::Contains("excluded"));
  EXPECT_EQ(json["masked"], json["vectors"]);
}

TEST_F(MaskedFrames, NeedMasksThatSuitThem) {
  expect_error_in(correlate("[[correlate.mask]]\nkind = \"image\"\nfile = \"missing.tif\"\n"),
                  "missing_file at missing.tif");
  Outcome const far = correlate("[[correlate.mask]]\nkind = \"polygon\"\nx_px = [90, 99, 90]\ny_px = [1, 2, 9]\n");
  EXPECT_EQ(far.exit_code, 2);
  expect_error_in(far, "invalid_value at correlate.mask", {"(90, 1)", "64 x 64 px"});
  Outcome const outcome = correlate("[[correlate.mask]]\nkind = \"polygon\"\nx_px = [1, 2]\ny_px = [1, 2]\n");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(errors_in(outcome.out),
              testing::ElementsAre("wrong_type at config.toml:5:1", "wrong_type at config.toml:6:1"));
}

/// Pairs with one common displacement.
class Ensembles : public MaskedFrames {};

// Three identical pairs give the result of one; the hash of each frame is stored.
TEST_F(Ensembles, OfOnePairRepeatedAreThatPair) {
  write("config.toml", "[correlate]\nwindow_px = [16]\n");
  std::string const a = "case/reference.tif", b = "case/flow.tif";
  ASSERT_EQ(gladstone({"correlate", a, b, "--config", "config.toml", "-o", "one.h5"}).exit_code, 0);
  Outcome const outcome =
      gladstone({"correlate", "--ensemble", a, b, a, b, a, b, "--config", "config.toml", "-o", "three.h5"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  Hdf5Reader const one(in("one.h5").string()), three(in("three.h5").string());
  EXPECT_EQ(three.attribute("reference_1_sha256"), one.attribute("reference_sha256"));
  EXPECT_EQ(three.attribute("flow_3_sha256"), one.attribute("flow_sha256"));
  auto const u = one.read("/u_raw_px"), mean = three.read("/u_raw_px");
  ASSERT_EQ(u.size(), mean.size());
  // Sums and thirds of correlation planes in float have rounding errors of 1e-7 of the peak. The Gaussian fit divides
  // them by the curvature of the peak, 0.1 to 1 per square pixel, in every pass: 1e-5 px at most, with a factor of ten.
  for (std::size_t i = 0; i < u.size(); ++i) EXPECT_NEAR(u[i], mean[i], 1e-4);
  EXPECT_EQ(three.attribute("verdict_code"), one.attribute("verdict_code"));
}

// A pair of identical images biases the mean towards 0, which no verdict detects.
TEST_F(Ensembles, NamePairsOfOnePicture) {
  std::string const a = "case/reference.tif", b = "case/flow.tif";
  auto const json = json_of({"correlate", "--ensemble", a, b, a, a, "-o", "v.h5", "--set", "correlate.window_px=[16]"});
  EXPECT_THAT(warnings_in(json), testing::Contains("unreliable at reference.tif"));
}

TEST_F(Ensembles, AreOfPairs) {
  std::string const a = "case/reference.tif", b = "case/flow.tif";
  expect_error({"correlate", "--ensemble", a, b, a, "-o", "v.h5"}, 2, "arguments at --ensemble");
  expect_error({"correlate", a, b, a, "-o", "v.h5"}, 2, "arguments at images");
}

}  // namespace
}  // namespace gladstone::end_to_end
