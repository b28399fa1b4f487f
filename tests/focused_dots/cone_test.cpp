#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "render/base/units.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

/// A sinusoid along x whose gradient has its maximum on the axis.
Setup sinusoid_setup(double wavelength, double peak_gradient) {
  auto setup = table1_setup(64);
  setup.target.dot_diameter_px = 0;
  setup.medium.field = Sinusoid<double>::wave(peak_gradient * wavelength / (2 * pi), wavelength);
  return setup;
}

// F10 for points at Table 1 with L_z = 10 mm, by the numerical average of lever times 2 J1(pi D/L)/(pi D/L) over the
// slab: 0.620565 at 4 mm, 0.894131 at 8 mm. For the peak gradient of 0.5 kg/m^4, g = 0.1875 K L_z 0.5 (2 pi/4 mm) =
// 3.3e-4 < 1e-3; 2^13 points of a net add 1e-4. The ratio of the standard deviation of the rays' displacements to Eq. 9
// is 0.3519 and 0.1039.
TEST(ConeAveraging, KeepsTheFractionOfEq9ThatTheConeLeaves) {
  struct Case {
    double wavelength, kept, spread;
  };
  for (Case const& one : {Case{4e-3, 0.620565, 0.3519}, Case{8e-3, 0.894131, 0.1039}}) {
    PlannedScene scene =
        scene_with_dots(sinusoid_setup(one.wavelength, 0.5), {{31.5, 31.5}, {31.5, 5}, {28, 60}}, 1 << 13);
    GroundTruth const truth = trace_truth(scene);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_NEAR(truth.displacement_px[i].x / truth.eq9_px[i].x, one.kept, 1e-3) << i;
      EXPECT_NEAR(truth.eq9_cone_px[i].x / truth.eq9_px[i].x, one.kept, 1e-3) << i;
      EXPECT_NEAR(truth.displacement_px[i].y / truth.eq9_px[i].x, 0, 1e-3) << i;
    }
    EXPECT_NEAR(truth.displacement_std_px[0].x / std::abs(truth.eq9_px[0].x), one.spread, 1e-3);
  }
}

// Recomputes the integrals of F10, so that the two numbers above are verified independently.
TEST(ConeAveraging, FractionsAreThoseOfTheBesselAverage) {
  for (double const wavelength : {4e-3, 8e-3}) {
    double sum = 0, levers = 0;
    for (int i = 0; i < 1000; ++i) {
      double const s = 0.245 + 0.01 * (i + 0.5) / 1000, v = pi * (0.105 / 11) * s / wavelength;
      sum += s * 2 * std::cyl_bessel_j(1.0, v) / v;
      levers += s;
    }
    EXPECT_NEAR(sum / levers, wavelength < 6e-3 ? 0.620565 : 0.894131, 1e-6);
  }
}

// A disc of 3 px, 0.256 mm on the target, is 0.192 mm wide in the medium (Z_A/Z_B): this adds a factor 2 J1(v)/v with v
// = pi 0.192/4.
TEST(ConeAveraging, ADotsDiscAveragesToo) {
  auto setup = sinusoid_setup(4e-3, 0.5);
  setup.target.dot_diameter_px = 3;
  PlannedScene scene = scene_with_dots(setup, {{31.5, 31.5}}, 1 << 14);
  GroundTruth const truth = trace_truth(scene);
  double const v = pi * 0.75 * setup.dot_diameter() / 4e-3;
  double const disc = 2 * std::cyl_bessel_j(1.0, v) / v;
  EXPECT_NEAR(truth.eq9_cone_px[0].x / truth.eq9_px[0].x, 0.620565 * disc, 1e-3);
  EXPECT_NEAR(truth.displacement_px[0].x, truth.eq9_px[0].x * 0.620565 * disc, 2e-4);
}

// For rho = rho_0 + c x^2/2, the standard deviation of a point's rays on the target is Z_D K L_z c D_c/(4 n0) (for a
// uniform disc, it is a quarter of the diameter). For c = 1000 kg/m^5, the strain is g = 0.1875 K L_z c = 4e-4; float
// values in the file change the gradient by 1e-4.
TEST(ConeAveraging, QuadraticFieldSpreadsAPointByTheConesWidth) {
  std::string const path = (std::filesystem::path(testing::TempDir()) / "quadratic.nrrd").string();
  double const c = 1000;
  write_plane(path, 61, 9, [&](int i, int) { return 1.225 + 0.5 * c * std::pow((i - 30) * 0.5e-3, 2); });
  auto setup = table1_setup(64);
  setup.target.dot_diameter_px = 0;
  setup.medium.field.kind = FieldKind::file;
  setup.medium.field.file = path;
  setup.medium.field.where = "test";
  setup.medium.field.spacing = Vec3d{0.5e-3, 2e-3, 1e-3};
  setup.medium.field.extrude = true;
  PlannedScene scene = scene_with_dots(setup, {{31.5, 31.5}}, 1 << 12);
  GroundTruth const truth = trace_truth(scene);
  double const cone = 0.105 / 11 * 0.25, n0 = 1 + 2.26e-4 * 1.225;
  double const spread = 0.25 * 2.26e-4 * 0.01 * c * cone / (4 * n0) * scene.imaging.magnification / 10e-6;
  EXPECT_NEAR(truth.displacement_std_px[0].x / spread, 1, 2e-3);
  EXPECT_NEAR(truth.displacement_std_px[0].y / spread, 0, 2e-3);
  EXPECT_NEAR(truth.displacement_px[0].x / spread, 0, 5e-3);  // symmetric about the axis
}

}  // namespace
}  // namespace gladstone
