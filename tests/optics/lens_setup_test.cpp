#include "render/optics/lens_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/support/expect_error.h"
#include "tests/support/folder_fixture.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

LensSetup read(std::string const& text) {
  SetupDocument document = SetupDocument::from_text("[lens]\n" + text, "lens.toml");
  LensSetup const setup = read_lens_setup(document.root().table("lens"));
  document.finish();
  return setup;
}

TEST(LensSetup, DefaultsAreTable1) {
  LensSetup const setup = read("");
  EXPECT_DOUBLE_EQ(setup.focal_length, 0.105);
  EXPECT_DOUBLE_EQ(setup.f_number, 11);
  EXPECT_EQ(setup.focus, Focus::target);
  EXPECT_EQ(setup.spot, SpotModel::gaussian);
}

TEST(LensSetup, ReadsEveryKey) {
  LensSetup const setup = read("focal_length_mm = 50\nf_number = inf\nfocus_distance_mm = 800\npsf = \"airy\"\n");
  EXPECT_DOUBLE_EQ(setup.focal_length, 0.05);
  EXPECT_TRUE(std::isinf(setup.f_number));
  EXPECT_EQ(setup.focus, Focus::distance);
  EXPECT_DOUBLE_EQ(setup.focus_distance, 0.8);
  EXPECT_EQ(setup.spot, SpotModel::airy);
  EXPECT_EQ(read("focus = \"medium\"").focus, Focus::medium);
  EXPECT_EQ(read("psf = \"none\"").spot, SpotModel::none);
  EXPECT_EQ(read("psf = \"seed_eq8\"").spot, SpotModel::seed_eq8);
  EXPECT_EQ(read("psf = \"gaussian_first_zero\"").spot, SpotModel::gaussian_first_zero);
}

TEST(LensSetup, NamesItsPrescription) {
  LensSetup const setup = read("model = \"prescription\"\nfile = \"double_gauss.toml\"\nf_number = 8\n");
  EXPECT_THAT(setup.file, HasSubstr("double_gauss.toml"));
  EXPECT_DOUBLE_EQ(setup.f_number, 8);
  EXPECT_TRUE(std::isnan(read("model = \"prescription\"\nfile = \"double_gauss.toml\"\n").f_number));
}

TEST(LensSetup, ImpossibleLensesAreRefused) {
  EXPECT_THAT([] { read("focal_length_mm = -105\n"); }, ThrowsSetupError(ErrorCode::out_of_range, "lens.toml:2:1"));
  EXPECT_THAT([] { read("f_number = 0\n"); }, ThrowsSetupError(ErrorCode::out_of_range, "lens.f_number"));
  EXPECT_THAT([] { read("f_number = nan\n"); }, ThrowsSetupError(ErrorCode::out_of_range, "lens.f_number"));
  EXPECT_THAT([] { read("focus = \"target\"\nfocus_distance_mm = 900\n"); },
              ThrowsSetupError(ErrorCode::invalid_value, "lens.toml:3:1"));
}

/// Reads a setup, "setup.toml", with a lens prescription in its third line, and builds the lens.
void build_lens_of(std::string const& file) {
  SetupDocument document =
      SetupDocument::from_text("[lens]\nmodel = \"prescription\"\nfile = \"" + file + "\"\n", "setup.toml");
  SetupTable const table = document.root().table("lens");
  LensSetup setup = read_lens_setup(table);
  Warnings warnings;
  build_prescription(setup, table, GlassCatalogue::shipped(), spectral_line::d, std::nullopt, warnings);
  document.finish();
}

// A lens with water ahead of it would be focused incorrectly, since scenes are in gas, and is refused.
TEST(LensSetup, ALensInWaterIsRefused) {
  auto const build = [] {
    build_lens_of(std::string(GLADSTONE_DATA_DIR) + "/../tests/cases/lenses/object_in_water.zmx");
  };
  EXPECT_EQ(error_of(build), "invalid_value at setup.toml:3:1");
}

class LensFile : public FolderFixture {};

TEST_F(LensFile, HasOneRecordForEachOfItsProblems) {
  write("bad.toml",
        "schema = 1\nf_number = \"wide\"\nfield_deg = [0.0]\n[[surface]]\nradius_mm = 51.5\nthickness_mm = 3.6\n"
        "index = 1.5168\nstop = true\nsemi_diametre_mm = 12.7\n[[surface]]\nsemi_diameter_mm = 12.7\n");
  try {
    build_lens_of(in_folder("bad.toml"));
    FAIL() << "the lens is accepted";
  } catch (SetupError const& error) {
    ASSERT_EQ(error.problems().size(), 2u) << error.what();
    std::map<ErrorCode, std::string> lines;
    for (SetupProblem const& problem : error.problems()) {
      EXPECT_EQ(problem.where, "setup.toml:3:1");
      EXPECT_EQ(problem.key, "lens.file");
      lines[problem.code] = problem.message;
    }
    EXPECT_THAT(lines[ErrorCode::wrong_type], HasSubstr("bad.toml:2:1: "));
    EXPECT_THAT(lines[ErrorCode::unknown_key], HasSubstr("bad.toml:9:1: "));
  }
}

}  // namespace
}  // namespace gladstone
