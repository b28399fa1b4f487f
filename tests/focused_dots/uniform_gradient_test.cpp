#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

#include "render/base/units.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

/// Sensitivity of Eq. 9 for Table 1: 0.006626657 px per kg/m^4.
constexpr double px_per_gradient = 0.006626657;

/// Returns the shift of a whole image from the phase of its lowest Fourier modes; exact for a rigid shift of an image
/// with a dark border.
Vec2d shift_by_phase(Image<double> const& from, Image<double> const& to) {
  auto const mode = [](Image<double> const& image, int k, int l) {
    std::complex<double> sum = 0;
    for (int row = 0; row < image.rows(); ++row) {
      for (int column = 0; column < image.columns(); ++column) {
        sum += image(column, row) *
               std::polar(1.0, -2 * pi * (k * column / double(image.columns()) + l * row / double(image.rows())));
      }
    }
    return sum;
  };
  Vec2d shift{};
  double weight_x = 0, weight_y = 0;
  for (int k = 1; k <= 4; ++k) {
    std::complex<double> const x = mode(to, k, 0) * std::conj(mode(from, k, 0));
    std::complex<double> const y = mode(to, 0, k) * std::conj(mode(from, 0, k));
    shift.x -= std::abs(x) * std::arg(x) * from.columns() / (2 * pi * k);
    shift.y -= std::abs(y) * std::arg(y) * from.rows() / (2 * pi * k);
    weight_x += std::abs(x), weight_y += std::abs(y);
  }
  return {shift.x / weight_x, shift.y / weight_y};
}

// Dots are displaced against grad n: to the left if the density increases to the right, downwards (v > 0) if it
// increases upwards.
TEST(UniformGradient, MovesDotsAgainstTheGradient) {
  struct Case {
    Vec2d gradient;
    double u, v;
  };
  for (Case const& one : {Case{{10, 0}, -1, 0}, Case{{-10, 0}, 1, 0}, Case{{0, 10}, 0, 1}, Case{{0, -10}, 0, -1}}) {
    auto setup = table1_setup(64);
    setup.target.dot_diameter_px = 0;
    setup.medium.field = uniform_gradient(one.gradient.x, one.gradient.y);
    PlannedScene scene = scene_with_dots(setup, {{31.5, 31.5}}, 64);
    GroundTruth const truth = trace_truth(scene);
    // Eq. 9 to the digits of the printed sensitivity; the truth differs by F27's theta^2, averaged over the cone, (4.77
    // mrad)^2/2 = 1.1e-5
    EXPECT_NEAR(truth.eq9_px[0].x, one.u * 10 * px_per_gradient, 1e-8);
    EXPECT_NEAR(truth.eq9_px[0].y, one.v * 10 * px_per_gradient, 1e-8);
    EXPECT_NEAR(truth.displacement_px[0].x, one.u * 10 * px_per_gradient, 1.5e-5 * 0.0663);
    EXPECT_NEAR(truth.displacement_px[0].y, one.v * 10 * px_per_gradient, 1.5e-5 * 0.0663);
    EXPECT_NEAR(truth.eq9_cone_px[0].x, one.u * 10 * px_per_gradient, 1.5e-5 * 0.0663);
  }
}

// F27 for a chief ray at the angle theta, in the plane of the gradient: the ratio of truth to Eq. 9 is 1 + theta^2 with
// matched faces and 1 + 2 theta^2 with refracting ones; perpendicular to it, it is 1 + theta^2 in both cases. With
// refracting faces, the slab is also a plane plate of index n0 + a x, x = Z_A theta at the ray, which shifts the ray by
// L_z theta a x/n0 in the opposite direction: -theta^2 Z_A/Z_D = -3 theta^2 in the plane of the gradient. The next
// terms are of order theta^4 and K g x.
TEST(UniformGradient, DepartsFromEq9ByTheSquareOfTheFieldAngle) {
  for (Faces const faces : {Faces::matched, Faces::refract}) {
    for (bool const along : {true, false}) {
      auto setup = table1_setup(512);
      setup.lens.f_number = std::numeric_limits<double>::infinity();
      setup.target.dot_diameter_px = 0;
      setup.medium.faces = faces;
      setup.medium.field = uniform_gradient(along ? 0.1 : 0, along ? 0 : 0.1);
      PlannedScene scene = scene_with_dots(setup, {{0, 255.5}, {511, 255.5}}, 1);
      GroundTruth const truth = trace_truth(scene);
      for (std::size_t i = 0; i < 2; ++i) {
        double const theta2 = std::pow(scene.dots.centre[i].x, 2);
        EXPECT_NEAR(theta2, 4.74e-4, 1e-6);
        double const ratio =
            along ? truth.displacement_px[i].x / truth.eq9_px[i].x : truth.displacement_px[i].y / truth.eq9_px[i].y;
        double const factor = faces == Faces::refract && along ? 2.0 - 0.75 / 0.25 : 1.0;
        EXPECT_NEAR((ratio - 1) / theta2, factor, 5e-3) << static_cast<int>(faces) << along << i;
      }
    }
  }
}

// The image as a whole is shifted by the mean truth of its dots, measured by an estimator that is independent of ray
// tracing, for both signs and both axes. For a PSF of sigma 1.25 px (seed_eq8), the aliasing of pixels is below 1e-6;
// dots differ by 1e-5 px due to the field angle; and the light of a dot, which changes the phase of a low mode in
// proportion to its distance from the centre (30 px), is repeatable to a few 1e-5 with 2^16 rays.
TEST(UniformGradient, ImagesShiftByTheTruth) {
  for (Vec2d const gradient : {Vec2d{100, 0}, Vec2d{-100, 0}, Vec2d{0, 100}, Vec2d{0, -100}, Vec2d{150, -40}}) {
    auto setup = table1_setup(96);
    setup.lens.spot = SpotModel::seed_eq8;
    setup.medium.field = uniform_gradient(gradient.x, gradient.y);
    PlannedScene scene = scene_with_dots(
        setup, {{20.3, 18.9}, {60.7, 25.2}, {35.5, 50.1}, {71.4, 73.8}, {22.6, 70.9}, {49.0, 33.3}}, 1 << 16);
    Rendering const rendering = render_all(scene);
    Vec2d truth{};
    for (Vec2d const displacement : rendering.truth.displacement_px) truth += displacement / 6.0;
    Vec2d const measured = shift_by_phase(rendering.light.reference, rendering.light.flow);
    EXPECT_NEAR(measured.x, truth.x, 1e-3);
    EXPECT_NEAR(measured.y, truth.y, 1e-3);
    EXPECT_NEAR(measured.x, -px_per_gradient * gradient.x, 2e-3);
    EXPECT_NEAR(measured.y, px_per_gradient * gradient.y, 2e-3);
  }
}

// Rays are straight to high accuracy: eps is 2e-4 at 100 kg/m^4, and eps^2 below 1e-7. The error of Euler's steps is
// half a step of the lever; if halving the step removes less than 1e-4 px of a first-order error, the error itself is
// below 2e-4 px.
TEST(UniformGradient, IntegratorsAgree) {
  Vec2d displacement[3];
  int i = 0;
  for (Integrator const integrator : {Integrator::rk4, Integrator::euler, Integrator::straight}) {
    auto setup = table1_setup(64);
    setup.target.dot_diameter_px = 0;
    setup.medium.field = uniform_gradient(100, 0);
    setup.medium.integrator = integrator;
    PlannedScene scene = scene_with_dots(setup, {{31.5, 31.5}}, 64);
    displacement[i++] = trace_truth(scene).displacement_px[0];
  }
  EXPECT_NEAR(displacement[0].x, displacement[2].x, 1e-6);
  EXPECT_NEAR(displacement[0].x, displacement[1].x, 2e-4);
}

}  // namespace
}  // namespace gladstone
