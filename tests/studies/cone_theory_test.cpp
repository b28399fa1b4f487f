#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/scene/ray_plan.h"
#include "render/scene/renderer.h"

namespace gladstone {
namespace {

/// Strain of Eq. 9 at the steepest place of the wave, g = (Z_A Z_D / Z_B) d(epsilon)/dx: what lets other rays through
/// the stop in the flow than in the reference is of this order, and leaves the fundamental in the second.
constexpr double strain = 5e-4;
constexpr double wavelength = 8e-3;        // of the density [m]
constexpr double corner = 1.0 * pi / 180;  // angle to the axis, of the outermost dots [rad]

struct Bench {
  double focal_length_mm, f_number, z_d_mm;

  std::string text() const { return fmt::format("f = {} mm, f/{}, Z_D = {} mm", focal_length_mm, f_number, z_d_mm); }
};

/// Table 1 with this lens and distance, points for dots, and a wave of that strain.
Scene scene_of(Bench const& bench) {
  Scene scene;
  Setup& setup = scene.setup;
  setup.lens.focal_length = bench.focal_length_mm * 1e-3;
  setup.lens.f_number = bench.f_number;
  setup.z_d = bench.z_d_mm * 1e-3;
  setup.target.dot_diameter_px = 0;
  FieldSetup& field = setup.medium.field;
  field.kind = FieldKind::sinusoid;
  field.wavelength = wavelength;
  double const k = 2 * pi / field.wavelength;
  double const lever = setup.z_a * setup.z_d / setup.z_b();
  field.amplitude =
      strain * setup.ambient_index() / (lever * setup.medium.gladstone_dale * setup.medium.thickness * k * k);
  scene.imaging = setup.imaging();
  scene.medium = build_medium(setup.medium);
  // A square of points whose corners are seen at that angle; the spacing has nothing in common with the wave.
  double const half = setup.z_b() * std::tan(corner) / std::sqrt(2.0);
  constexpr int side = 10;
  for (int j = 0; j <= side; ++j) {
    for (int i = 0; i <= side; ++i)
      scene.dots.centre.push_back({half * (2.0 * i / side - 1), half * (2.0 * j / side - 1)});
  }
  plan_step(scene);
  scene.rays_per_dot = 1024;
  return scene;
}

/// What physics.md's F10 makes of a wave: the mean of 2 J1(x) / x over the thickness, x = pi D_c(s) / wavelength, each
/// slice with its distance from the dots, s, as lever and the cone's diameter there, D_c(s) = (f / N) s / Z_B.
double cone_transfer(Setup const& setup) {
  double const pupil = setup.lens.focal_length / setup.lens.f_number;
  double sum = 0, levers = 0;
  constexpr int slices = 2000;
  for (int i = 0; i < slices; ++i) {
    double const s = setup.z_d + setup.medium.thickness * ((i + 0.5) / slices - 0.5);
    double const x = pi * pupil * s / setup.z_b() / setup.medium.field.wavelength;
    sum += s * 2 * std::cyl_bessel_j(1.0, x) / x;
    levers += s;
  }
  return sum / levers;
}

/// Amplitudes of cos(k x) and sin(k x) that fit values best.
Vec2d fundamental(std::vector<double> const& phase, std::vector<double> const& value) {
  double cc = 0, cs = 0, ss = 0, cv = 0, sv = 0;
  for (std::size_t i = 0; i < phase.size(); ++i) {
    double const c = std::cos(phase[i]), s = std::sin(phase[i]);
    cc += c * c, cs += c * s, ss += s * s, cv += c * value[i], sv += s * value[i];
  }
  double const det = cc * ss - cs * cs;
  return {(ss * cv - cs * sv) / det, (cc * sv - cs * cv) / det};
}

/// Focal length [mm].
class ConeTheory : public testing::TestWithParam<double> {};

// Over every stop and distance of this grid the rays' fundamental is that of F10, Eq. 9 times the cone's transfer, in
// amplitude and phase, to 2e-3 of itself: where the transfer is 0.999 as well as beyond its zeros, down to -0.129;
// nearest to zero it is -0.019. What F10 leaves out is the obliquity of the rays, the square of the angle: 3e-4 in the
// corners, up to 1e-3 at the rim of the widest pupil; the wave's phase over the thickness, at most (k L tan(1 degree) /
// 2)^2 / 6 = 8e-4; and the second order of the strain. Means over the view, they reach 1e-4 of Eq. 9 where the cone is
// widest.
TEST_P(ConeTheory, IsWhatRaysDoOverTheWholeGrid) {
  CpuRenderer renderer;
  double worst = 0;
  for (double const f_number : {4.0, 8.0, 16.0, 32.0}) {
    for (double const z_d_mm : {100.0, 250.0, 500.0, 1000.0}) {
      Bench const bench{GetParam(), f_number, z_d_mm};
      Scene scene = scene_of(bench);
      GroundTruth const truth = renderer.render(scene, scene.dots, RenderImages::no, RenderTheory::no).truth;
      auto const& setup = scene.setup;
      double const k = 2 * pi / setup.medium.field.wavelength;
      double const eq9 = scene.imaging.magnification * setup.z_d * setup.medium.gladstone_dale *
                         setup.medium.thickness * setup.medium.field.amplitude * k /
                         (setup.ambient_index() * setup.camera.pixel_pitch);
      std::vector<double> phase, displacement;
      for (std::size_t i = 0; i < truth.size(); ++i) {
        // where the chief ray crosses the mid-plane; dots appear displaced against the gradient
        phase.push_back(k * scene.dots.centre[i].x * setup.z_a / setup.z_b());
        displacement.push_back(-truth.displacement_px[i].x);
      }
      Vec2d const rays = fundamental(phase, displacement);
      double const deviation = length(rays - Vec2d{eq9 * cone_transfer(setup), 0}) / length(rays);
      EXPECT_LT(deviation, 2e-3) << bench.text() << ", transfer " << cone_transfer(setup);
      worst = std::max(worst, deviation);
    }
  }
  RecordProperty("worst_deviation", fmt::format("{:.2e}", worst));
}

INSTANTIATE_TEST_SUITE_P(FocalLengths, ConeTheory, testing::Values(50.0, 105.0, 200.0));

}  // namespace
}  // namespace gladstone
