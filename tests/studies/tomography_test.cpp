#include "studies/compare/tomography.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "render/base/error.h"
#include "render/medium/field_volume.h"
#include "studies/compare/tomography_file.h"
#include "studies/compare/tomography_plan.h"
#include "studies/compare/tomography_view.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr char const* blob_text = R"(
[camera]
pixels = [64, 64]
pixel_pitch_um = 40.0
[geometry]
z_a_mm = 750.0
z_d_mm = 250.0
[medium.field]
kind = "gaussian_blob"
amplitude_kg_m3 = -0.5
radius_mm = 2.5
)";

std::string write_blob_setup(std::string const& name, std::string const& more = "") {
  std::string const path = testing::TempDir() + name;
  std::ofstream(path) << blob_text << more;
  return path;
}

// The lens of a camera on the Z axis is its pupil, at Z = z_a: every sight line passes it, and starts on the dots'
// plane at the magnification of the lens. A volume turned by 90 degrees about Y sees the camera along -X.
TEST(TomographyView, SightLinesPassThePupil) {
  CaseSetup const loaded = load_case_setup(write_blob_setup("sight.toml"), {});
  std::vector<Vec2d> const at{{31.5, 31.5}, {10.0, 50.0}, {60.0, 5.0}};
  tomography::ViewOptics const optics = trace_sight_lines(loaded.setup, at, Pose<double>{});
  double const metres_per_px = loaded.setup.camera.pixel_pitch / loaded.setup.imaging().magnification;
  for (std::size_t i = 0; i < at.size(); ++i) {
    ASSERT_TRUE(optics.sights[i].has_value());
    tomography::SightLine const& line = optics.sights[i]->line;
    EXPECT_NEAR(line.origin.x, (at[i].x - 31.5) * metres_per_px, 1e-9);
    EXPECT_NEAR(line.origin.y, -(at[i].y - 31.5) * metres_per_px, 1e-9);
    EXPECT_NEAR(line.origin.z, -0.25, 1e-12);
    EXPECT_LT(length(line.origin + line.pupil_distance * line.direction - Vec3d{0.0, 0.0, 0.75}), 1e-6);
    EXPECT_NEAR(optics.sights[i]->by_column.x, metres_per_px, 1e-6 * metres_per_px);
    EXPECT_NEAR(optics.sights[i]->by_row.y, -metres_per_px, 1e-6 * metres_per_px);
    EXPECT_NEAR(line.scale, 3.0, 1e-6);  // z_a / z_d
  }
  double const quarter_turn = 0.5 * M_PI;
  tomography::ViewOptics const turned = trace_sight_lines(loaded.setup, at, turned_volume(quarter_turn));
  EXPECT_NEAR(turned.sights[0]->line.direction.x, -1.0, 1e-9);
}

// The field of a plan is that of the setup, turned: for a blob the same in every view, here at the nodes of the file,
// to the precision of single numbers and of the cubic spline. It reads back as the field of a setup.
TEST(TomographyPlan, TurnedFieldsAreReadBack) {
  std::string const folder = testing::TempDir() + "tomography_plan";
  std::filesystem::create_directories(folder);
  std::vector<std::string> const setups = write_tomography_setups({write_blob_setup("plan.toml"), 3, M_PI}, folder);
  ASSERT_EQ(setups.size(), 3u);
  for (std::string const& path : setups) {
    CaseSetup const view = load_case_setup(path, {});
    BuiltMedium const medium = build_medium(view.setup.medium);
    std::visit(
        [&](auto const& field) {
          for (double const x : {0.0, 1.1e-3, -2.7e-3}) {
            double const density =
                field.sample(Vec3d{x, 0.3e-3, -0.7e-3}).refractivity / view.setup.medium.gladstone_dale;
            double const r2 = x * x + 0.09e-6 + 0.49e-6;
            EXPECT_NEAR(density, 1.225 - 0.5 * std::exp(-r2 / 6.25e-6), 1e-4);
          }
        },
        medium.view);
  }
}

TEST(Tomography, OptionsThatDetermineNoVolumeAreReportedTogether) {
  TomographyOptions options;
  options.views = {"a", "b"};
  options.angles = {0.0};
  options.spacing = -1.0;
  try {
    reconstruct_views(options, tomography::make_host_volume);
    FAIL();
  } catch (SetupError const& error) {
    EXPECT_EQ(error.problems().size(), 4u);  // views, --angles, --reference, --spacing
  }
}

TEST(Tomography, MissingViewIsRefused) {
  TomographyOptions options;
  options.views = {testing::TempDir() + "nowhere_a", testing::TempDir() + "nowhere_b",
                   testing::TempDir() + "nowhere_c"};
  options.reference.push_back({density::GridSide::left});
  EXPECT_THROW(reconstruct_views(options, tomography::make_host_volume), DataError);
}

/// Three views of a uniform displacement, with the left side of the images as reference.
TomographyOptions three_views() {
  TomographyOptions options;
  std::string vectors = "x_px,y_px,u_px,v_px\n";
  for (int y = 8; y <= 56; y += 8)
    for (int x = 8; x <= 56; x += 8) vectors += std::to_string(x) + "," + std::to_string(y) + ",0.01,0.02\n";
  for (char const* name : {"one", "two", "three"}) {
    options.views.push_back(write_blob_setup(std::string(name) + ".toml"));
    options.vectors.push_back(testing::TempDir() + name + ".csv");
    std::ofstream(options.vectors.back()) << vectors;
  }
  options.reference.push_back({density::GridSide::left});
  return options;
}

auto reconstruction(TomographyOptions const& options) {
  return [&options] { reconstruct_views(options, tomography::make_host_volume); };
}

// Views from one side, or from two opposite ones, do not determine a volume.
TEST(Tomography, ViewsAlongOneLineAreRefused) {
  TomographyOptions options = three_views();
  options.angles = {0.0, M_PI, 2 * M_PI};
  EXPECT_EQ(error_of(reconstruction(options)), "undetermined at tomography");
  options.angles = {0.0, NAN, 2.0};
  EXPECT_EQ(error_of(reconstruction(options)), "invalid_value at --angles");
}

TEST(Tomography, AReferenceOutsideTheLimitsOfDensityIsRefused) {
  TomographyOptions options = three_views();
  options.largest_density = 0.1;  // the ambient density is 1.225
  auto const refused_with = [](char const* density) {
    return AllOf(ThrowsSetupError(ErrorCode::invalid_value, "--reference-density"),
                 ThrowsMessage<SetupError>(HasSubstr(density)));
  };
  EXPECT_THAT(reconstruction(options), refused_with("1.225"));
  options.largest_density = 2.0;
  options.reference_density = -1.0;
  EXPECT_THAT(reconstruction(options), refused_with("-1"));
}

// A box in mm is compared with the vectors in mm, and the message names both.
TEST(Tomography, ReferenceOutsideTheVectorsIsReportedInMillimetres) {
  TomographyOptions options = three_views();
  ReferenceRegion far;
  far.low = {0.1, 0.1};
  far.high = {0.11, 0.11};
  options.reference = {far};
  EXPECT_THAT(reconstruction(options), AllOf(ThrowsSetupError(ErrorCode::invalid_value, "reference"),
                                             ThrowsMessage<SetupError>(HasSubstr("100 to 110 mm"))));
}

}  // namespace
}  // namespace gladstone
