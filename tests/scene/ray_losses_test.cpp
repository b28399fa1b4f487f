#include "render/scene/ray_losses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/scene/real_lens_setups.h"

namespace gladstone {
namespace {

/// Returns the fraction of all rays sent that end at a place for a cause.
double share_of(RayLosses const& losses, std::string const& place, RayStatus cause, Frame frame) {
  double share = 0;
  for (ElementRayLoss const& lost : losses.lost) {
    if (lost.place == place && lost.cause == cause) share += lost.share[static_cast<std::size_t>(frame)];
  }
  return share;
}

// A stop of radius r on the first face of a plano-convex lens, R = 51.5 mm, t = 3.6 mm, n = 1.5168. Light of a point at
// the distance D fills its second face up to y2 = r (1 + t / (n D) - t (n - 1) / (n R)); an edge of 3 mm there blocks
// the outer part. 256 uniformly distributed points determine areas to about two hundredths.
TEST(RayLosses, AreCountedBySurfaceAndCause) {
  std::string const path = testing::TempDir() + "ray_losses_singlet.toml";
  std::ofstream(path) << "schema = 1\nf_number = 10.0\n[[surface]]\nradius_mm = 51.5\nthickness_mm = 3.6\n"
                         "index = 1.5168\nstop = true\n[[surface]]\nsemi_diameter_mm = 3.0\n";
  auto setup = table1_setup(64);
  setup.lens.prescription =
      std::make_shared<Lens const>(build_lens(read_prescription(path), GlassCatalogue::shipped(), 532e-9));
  setup.lens.focal_length = paraxial_lens(*setup.lens.prescription).effective_focal_length;
  setup.lens.f_number = 10;
  PlannedScene const scene = scene_with_dots(setup, {{31.5, 31.5}}, 32);
  RayLosses const losses = sample_ray_losses(scene, scene.plan);
  EXPECT_EQ(losses.sources, 1u);
  EXPECT_EQ(losses.rays, 256u);
  double const r = 51.5 / 0.5168 / 20, rim = r * (1 + 3.6 / (1.5168 * 1000) - 3.6 * 0.5168 / (1.5168 * 51.5));
  double const lost = share_of(losses, "surface 2", RayStatus::vignetted, Frame::reference);
  EXPECT_NEAR(lost, 1 - 9 / (rim * rim), 0.03);
  EXPECT_GT(lost, 0.3);
  EXPECT_LT(share_of(losses, "surface 1", RayStatus::vignetted, Frame::reference), 0.02) << "the stop blocks no ray";
  EXPECT_EQ(share_of(losses, "surface 2", RayStatus::vignetted, Frame::flow), lost) << "there is no medium";
}

// A uniform gradient deflects all rays by e = K L |grad rho| and displaces them by s = e Z_A on the lens. Of the rays
// that pass the stop of radius r without the medium, the fraction 1 - (2 / pi) (acos q - q sqrt(1 - q^2)), q = s / (2
// r), is then blocked.
TEST(RayLosses, ReportRaysDeflectedPastStop) {
  auto setup = table1_setup(64);
  setup.medium.field = uniform_gradient(150, 0);
  PlannedScene const scene = scene_with_dots(setup, lattice(64, 3, 18), 32);
  RayLosses const losses = sample_ray_losses(scene, scene.plan);
  EXPECT_EQ(losses.sources, 9u);
  double const q = 2.26e-4 * 0.01 * 150 * 0.75 / (105e-3 / 11);
  double const lost = 1 - 2 / pi * (std::acos(q) - q * std::sqrt(1 - q * q));
  EXPECT_NEAR(share_of(losses, "stop", RayStatus::vignetted, Frame::flow), lost, 0.2 * lost);
  EXPECT_LT(share_of(losses, "stop", RayStatus::vignetted, Frame::reference), 0.1 * lost);
}

// For a double Gauss behind a window, light is lost at the edges of the lens, not at the faces of the window: surfaces
// of the lens are numbered as without the window. At f/2, the stop transmits almost all light that the edges transmit.
TEST(RayLosses, NameSurfacesBehindAWindowAsTheLensCountsThem) {
  auto setup = double_gauss_setup(64, 2);
  OpticalWindow window;
  window.side = ElementSide::camera;
  window.glass = "N-BK7";
  window.index = 1.5195;
  window.thickness = 10e-3;
  window.position = {0, 0, 100e-3};
  setup.elements = {window};
  PlannedScene const scene = scene_with_dots(setup, {{2, 2}, {61, 61}}, 32);
  RayLosses const losses = sample_ray_losses(scene, scene.plan);
  EXPECT_FALSE(losses.lost.empty());
  for (ElementRayLoss const& lost : losses.lost) {
    EXPECT_EQ(lost.place.find("surface"), 0u) << lost.place << ": light is lost at the edges of the lens only";
  }
}

}  // namespace
}  // namespace gladstone
