#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "render/base/units.h"
#include "render/optics/glass_catalogue.h"
#include "render/optics/paraxial.h"
#include "render/scene/build_camera.h"
#include "render/scene/setup.h"
#include "tests/scene/read_setup_text.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

Setup setup_of(std::string const& text) { return read_setup_text(text).setup; }

std::string double_gauss(std::string const& more = "") {
  return "[lens]\nmodel = \"prescription\"\nfile = \"" + std::string(GLADSTONE_DATA_DIR) +
         "/lenses/double_gauss.toml\"\n" + more;
}

// If the camera looks at a point, its axis runs through that point, and the image columns are vertical.
TEST(CameraPose, LooksAtAPoint) {
  gladstone::Setup const setup =
      setup_of("[camera.pose]\nposition_mm = [300, 0, 700]\nlook_at_mm = [0, 0, 0]\n[geometry]\nz_d_mm = 70\n");
  Pose<double> const pose = setup.camera_pose();
  double const far = std::hypot(0.3, 0.7);
  EXPECT_NEAR(length(pose.z - Vec3d{0.3 / far, 0, 0.7 / far}), 0, 1e-15);
  EXPECT_NEAR(pose.x.y, 0, 1e-15);
  EXPECT_NEAR(pose.y.y, 1, 1e-15);
  EXPECT_NEAR(dot(cross(pose.x, pose.y), pose.z), 1, 1e-15);
  // distances along the axis: to Z = 0, and further to the dots, where the axis is 30 mm to the left
  EXPECT_NEAR(setup.z_a, far, 1e-15);
  EXPECT_NEAR(setup.z_b(), 1.1 * far, 1e-15);
  EXPECT_NEAR(setup.target_centre().x, -0.03, 1e-15);
  // this pose nearly equals a rotation about y by the angle to the axis
  gladstone::Setup const turned =
      setup_of("[camera.pose]\nposition_mm = [300, 0, 700]\nrotation_deg = [0, 23.19859051364819, 0]\n");
  EXPECT_NEAR(length(turned.camera_pose().z - pose.z), 0, 1e-12);
  EXPECT_NEAR(length(turned.camera_pose().x - pose.x), 0, 1e-12);
}

TEST(CameraPose, InvalidPoseIsRejected) {
  EXPECT_THAT([] { setup_of("[camera.pose]\nposition_mm = [0, 0, 700]\n[geometry]\nz_a_mm = 750\n"); },
              refused(ErrorCode::invalid_value, "4:1"));
  EXPECT_THAT([] { setup_of("[camera.pose]\nlook_at_mm = [0, 0, 0]\n"); }, refused(ErrorCode::missing_key, "1:"));
  EXPECT_THAT([] { setup_of("[camera.pose]\nposition_mm = [0, 0, -700]\n"); }, refused(ErrorCode::invalid_value, "1:"));
  EXPECT_THAT([] { setup_of("[camera.pose]\nposition_mm = [0, 700, 0]\n"); }, refused(ErrorCode::invalid_value, "1:"));
  EXPECT_THAT(
      [] { setup_of("[camera.pose]\nposition_mm = [0, 0, 700]\nlook_at_mm = [0, 0, 0]\nrotation_deg = [0, 0, 0]\n"); },
      refused(ErrorCode::invalid_value, "4:1"));
  EXPECT_THAT([] { setup_of("[camera.sensor]\nscheimpflug = \"auto\"\ntilt_deg = [1, 0]\n"); },
              refused(ErrorCode::invalid_value, "2:1"));
}

TEST(Windows, AreReadWithTheirGlass) {
  gladstone::Setup const setup = setup_of(
      "[[window]]\nside = \"target\"\nglass = \"N-BK7\"\nthickness_mm = 20\nposition_mm = [0, 0, -100]\n"
      "[[window]]\nposition_mm = [0, 0, 100]\ntilt_deg = [5, 0]\n");
  ASSERT_EQ(setup.elements.size(), 2u);
  OpticalWindow const &first = *setup.elements[0].get<OpticalWindow>(),
                      &second = *setup.elements[1].get<OpticalWindow>();
  EXPECT_EQ(first.side, ElementSide::target);
  EXPECT_NEAR(first.index, 1.519472583, 1e-8);
  EXPECT_EQ(second.side, ElementSide::camera);
  EXPECT_NEAR(second.tilt.x, 5 * unit::degree, 1e-15);
  EXPECT_THAT([] { setup_of("[[window]]\n"); }, refused(ErrorCode::missing_key, "1:"));
}

TEST(Windows, OfUnknownGlassAreNamedOnceAtTheirKey) {
  EXPECT_EQ(error_of([] {
              setup_of(
                  "[[window]]\nposition_mm = [0, 0, 50]\n[[window]]\nglass = \"N-BK77\"\n"
                  "position_mm = [0, 0, 100]\n");
            }),
            "unknown_choice at case.toml:4:1");
}

// Transmittance of a plate of glass along the axis: 4 n / (n + 1)^2 at each face, and that of the glass catalogue for
// the thickness (10 mm of N-BK7 transmit 0.998 at 546 nm).
TEST(Windows, TakeOffTheLightThatIsAskedFor) {
  auto const passed = [](std::string const& transmittance) {
    Camera const camera = build_camera(setup_of("[lens]\ntransmittance = \"" + transmittance +
                                                "\"\n[[window]]\nthickness_mm = 25\nposition_mm = [0, 0, 100]\n"));
    Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
    RayAccount<double> account;
    EXPECT_EQ(carry(camera.view(), 0, camera.view().count, ray, account), RayStatus::alive);
    return account.weight;
  };
  double const n = 1.519472583, faces = std::pow(4 * n / ((n + 1) * (n + 1)), 2);
  EXPECT_EQ(passed("ideal"), 1);
  EXPECT_NEAR(passed("surfaces"), faces, 1e-9);
  Glass const& glass = *GlassCatalogue::shipped().match("N-BK7", 532e-9, "").glass;
  EXPECT_GT(glass.absorption(532e-9), 0);
  EXPECT_NEAR(passed("glass"), faces * std::exp(-0.025 * glass.absorption(532e-9)), 1e-9);
  EXPECT_NEAR(std::exp(-0.01 * glass.absorption(532e-9)), 0.998, 0.001);
}

TEST(PrescribedLens, SetsFocalLengthAndStop) {
  gladstone::Setup const own = setup_of(double_gauss());
  ASSERT_TRUE(own.lens.prescription);
  EXPECT_NEAR(own.lens.focal_length, 0.1, 1e-3);  // 100.00 mm at 587.6 nm; the wavelength is 532 nm here
  EXPECT_NEAR(own.lens.f_number, 2, 0.02);
  gladstone::Setup const stopped = setup_of(double_gauss("f_number = 8\n"));
  EXPECT_NEAR(stopped.lens.prescription->stop_radius / own.lens.prescription->stop_radius, 2.0 / 8, 0.01);
  // M = f / (Z_B - f), measured from the front principal plane
  EXPECT_NEAR(own.imaging().magnification, own.lens.focal_length / (1 - own.lens.focal_length), 1e-9);
}

/// Writes a file into the directory of temporary files. @return its name
std::string written_file(std::string const& name, std::string const& text) {
  std::string const path = testing::TempDir() + name;
  std::ofstream(path) << text;
  return path;
}

// A user's glass catalogue: n^2 = 1 + 1.25 lambda^2 / (lambda^2 - 0) = 2.25, and fused silica by Malitson (J. Opt. Soc.
// Am. 55 (1965) 1205), 1.460706345 at 532 nm. A lens of n = 1.5 with radii R = 100 mm and thickness t = 2 mm has 1/f =
// (n - 1) (2 / R - (n - 1) t / (n R^2)).
TEST(Glasses, OfOnesOwnCatalogueMakeLensesAndWindows) {
  std::string const own =
      written_file("own_glasses.agf",
                   "NM ROUND 2\nCD 1.25 0\nLD 0.3 2\nNM F_SILICA 2\nCD 0.6961663 0.00467914826 0.4079426 0.0135120631 "
                   "0.8974794 97.9340025\nLD 0.21 3.7\n");
  std::string const lens = written_file("own_lens.toml",
                                        "schema = 1\nf_number = 10\n[[surface]]\nradius_mm = 100\nthickness_mm = 2\n"
                                        "glass = \"ROUND\"\nstop = true\nsemi_diameter_mm = 8\n[[surface]]\n"
                                        "radius_mm = -100\nthickness_mm = 95\nsemi_diameter_mm = 8\n");
  std::string const model = "[lens]\nmodel = \"prescription\"\nfile = \"" + lens + "\"\n";
  std::string const window = "[[window]]\nglass = \"F_SILICA\"\nposition_mm = [0, 0, 100]\n";
  gladstone::Setup const setup = setup_of(model + "glasses = [\"" + own + "\"]\n" + window);
  EXPECT_NEAR(setup.lens.focal_length, 1 / (0.5 * (2 / 0.1 - 0.5 * 2e-3 / (1.5 * 0.01))), 1e-9);
  EXPECT_NEAR(setup.element<OpticalWindow>()->index, 1.460706345, 5e-10);
  EXPECT_THAT([&] { setup_of(model); }, refused(ErrorCode::unknown_choice, "3:1"));
  EXPECT_THAT([&] { setup_of("[lens]\nglasses = [\"none.agf\"]\n"); }, refused(ErrorCode::missing_file, "2:1"));
  EXPECT_THAT([&] { setup_of("[lens]\nglasses = [\"" + lens + "\"]\n"); }, refused(ErrorCode::missing_content, "2:1"));
}

TEST(PrescribedLens, MayBePlacedByItsFirstVertex) {
  gladstone::Setup const by_vertex = setup_of(double_gauss("[geometry]\nz_front_mm = 680\n"));
  double const principal = paraxial_lens(*by_vertex.lens.prescription).front_principal_plane;
  EXPECT_NEAR(by_vertex.z_a, 0.68 + principal, 1e-15);
  EXPECT_THAT([] { setup_of(double_gauss("[geometry]\nz_front_mm = 680\nz_a_mm = 750\n")); },
              refused(ErrorCode::invalid_value, "6:1"));
  EXPECT_THAT([] { setup_of("[geometry]\nz_front_mm = 680\n"); }, refused(ErrorCode::invalid_value, "2:1"));
}

TEST(PrescribedLens, ThatIsWrongIsNamed) {
  EXPECT_THAT([] { setup_of("[lens]\nmodel = \"prescription\"\n"); }, refused(ErrorCode::missing_key, "1:"));
  EXPECT_THAT([] { setup_of("[lens]\nmodel = \"prescription\"\nfile = \"none.zmx\"\n"); },
              refused(ErrorCode::missing_file, "3:1"));
  EXPECT_THAT([] { setup_of("[lens]\nfile = \"a.zmx\"\n"); }, refused(ErrorCode::invalid_value, "2:1"));
  EXPECT_THAT([] { setup_of(double_gauss("focal_length_mm = 100\n")); }, refused(ErrorCode::invalid_value, "4:1"));
  EXPECT_THAT([] { setup_of(double_gauss("[camera.sensor]\ndistortion = [0.1, 0, 0, 0]\n")); },
              refused(ErrorCode::invalid_value, "5:1"));
  // the dots are within the focal length
  EXPECT_THAT([] { setup_of(double_gauss("[geometry]\nz_a_mm = 60\nz_d_mm = 30\n")); },
              refused(ErrorCode::invalid_value, "3:1"));
}

}  // namespace
}  // namespace gladstone
