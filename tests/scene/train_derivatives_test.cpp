#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "render/base/units.h"
#include "render/optics/camera_element.h"
#include "render/scene/build_camera.h"
#include "tests/scene/real_lens_setups.h"

namespace gladstone {
namespace {

/// Parameters on which the landing position of a ray on the sensor depends.
enum Parameter {
  source_x,  // [m]
  source_y,
  source_z,
  aim_x,  // position on the aim plane, which determines the ray's direction [m]
  aim_y,
  sensor_distance,     // displacement of the sensor along its axis [m]
  window_tilt,         // rotation of the first face about its x axis [rad]
  curvature_added,     // change of a surface's curvature, or of the power of a thin lens [1/m]
  element_decentring,  // decentring of that surface along its x axis [m]
  parameters
};
using Jet = ceres::Jet<double, parameters>;
template <class T>
using Values = std::array<T, parameters>;

/// Returns the landing position of a ray as a function of all parameters. @param changed  element to which curvature
/// and decentring apply
template <class T>
Vec2<T> landing(Camera const& camera, int changed, Values<T> const& v) {
  std::vector<CameraElement<T>> elements;
  for (std::size_t i = 0; i < camera.elements.size(); ++i) {
    elements.push_back(in_scalar<T>(camera.elements[i]));
    elements.back() = elements.back().visit([&](auto held) -> CameraElement<T> {
      if (i == 0) held.pose = held.pose.turned({v[window_tilt], T(0), T(0)});
      if (static_cast<int>(i) != changed) return held;
      held.pose = held.pose.moved({v[element_decentring], T(0), T(0)});
      if constexpr (std::is_same_v<decltype(held), ShapedSurface<T, Quadric<T>>>) {
        held.shape.curvature = held.shape.curvature + v[curvature_added];
      }
      if constexpr (std::is_same_v<decltype(held), ShapedSurface<T, EvenAsphere<T>>> ||
                    std::is_same_v<decltype(held), ShapedSurface<T, RadialAsphere<T>>>) {
        held.shape.conic.curvature = held.shape.conic.curvature + v[curvature_added];
      }
      if constexpr (std::is_same_v<decltype(held), PosedThinLens<T>>) {
        held.focal_length = T(1) / (T(1) / held.focal_length + v[curvature_added]);
      }
      return held;
    });
  }
  PosedSensor<T> sensor = camera.sensor.in_scalar<T>();
  sensor.pose = sensor.pose.moved({T(0), T(0), v[sensor_distance]});
  auto const aim_plane = in_scalar<T>(camera.aim_plane);
  CameraView<T> const view{elements.data(), camera.before_medium, static_cast<int>(elements.size()), sensor, aim_plane};
  Vec3<T> const source{v[source_x], v[source_y], v[source_z]};
  Vec3<T> const aim = aim_plane.point_to_outer({v[aim_x], v[aim_y], T(0)});
  Ray<T> const ray{source, normalized(aim - source)};
  RayHit<T> const hit = trace_ray(view, NoMedium<T>{}, TracingOptions<T>{}, ray, T(1));
  EXPECT_TRUE(reaches_sensor_plane(hit.status));
  return hit.pixel;
}

/// Compares the derivatives of Jets with differences of eighth order. With steps h of 1e-2 of the length over which f
/// varies, the truncation error is (1e-2)^8 = 1e-16, and rounding of f over h contributes 1e-12 px for values of some
/// px. The tolerance is 1e-8 of each derivative.
void expect_exact_derivatives(Camera const& camera, int changed, Values<double> const& at) {
  Values<Jet> jets;
  for (int k = 0; k < parameters; ++k) jets[static_cast<std::size_t>(k)] = Jet(at[static_cast<std::size_t>(k)], k);
  Vec2<Jet> const traced = landing(camera, changed, jets);
  Vec2d const plain = landing(camera, changed, at);
  // the value of a Jet equals that in double, up to the rounding of fused products and sums
  EXPECT_NEAR(traced.x.a, plain.x, 1e-9);
  EXPECT_NEAR(traced.y.a, plain.y, 1e-9);
  Values<double> const steps{1e-4, 1e-4, 1e-3, 1e-4, 1e-4, 1e-4, 2e-4, 1e-2, 1e-5};
  double const weights[] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
  for (std::size_t k = 0; k < parameters; ++k) {
    Vec2d slope{};
    for (int i = 1; i <= 4; ++i) {
      Values<double> more = at, less = at;
      more[k] += i * steps[k];
      less[k] -= i * steps[k];
      slope = slope + weights[i - 1] / steps[k] * (landing(camera, changed, more) - landing(camera, changed, less));
    }
    auto const index = static_cast<Eigen::Index>(k);
    Vec2d const exact{traced.x.v[index], traced.y.v[index]};
    EXPECT_LT(length(exact - slope), 1e-8 * length(slope)) << "parameter " << k;
    EXPECT_GT(length(slope), 0) << "parameter " << k;
  }
}

OpticalWindow tilted_window() {
  OpticalWindow window;
  window.index = 1.5168;
  window.thickness = 10e-3;
  window.position = {0, 0, 0.1};
  window.tilt = {3 * unit::degree, -12 * unit::degree};
  return window;
}

constexpr Values<double> off_axis{0.012, -0.015, -0.25, 0.004, 0.007, 0, 0, 0, 0};

// The chain rule through a window, eleven surfaces and a tilted sensor, as computed by Jets, agrees with differences.
TEST(TrainDerivatives, ThroughADoubleGaussAreExact) {
  gladstone::Setup setup = double_gauss_setup(512, 4);
  setup.elements = {tilted_window()};
  setup.camera.tilt = {2 * unit::degree, -3 * unit::degree};
  Camera const camera = build_camera(setup);
  expect_exact_derivatives(camera, 6, off_axis);
}

// Like above, through an ideal lens with distortion of the image position.
TEST(TrainDerivatives, ThroughAThinLensAreExact) {
  gladstone::Setup setup = table1_setup(512);
  setup.elements = {tilted_window()};
  setup.camera.distortion = {-2.0, 10.0, 0.03, -0.05};
  Camera const camera = build_camera(setup);
  Values<double> at = off_axis;
  at[aim_x] = 0.001;
  at[aim_y] = 0.002;
  expect_exact_derivatives(camera, static_cast<int>(camera.elements.size()) - 1, at);
}

/// Returns the double Gauss with its last surface represented by another shape with the same conic.
template <class MakeShape>
Camera camera_with_last(MakeShape const& shape_of) {
  gladstone::Setup setup = double_gauss_setup(512, 4);
  Camera camera = build_camera(setup);
  CameraElement<double>& last = camera.elements.back();
  last = last.visit([&](auto const& held) -> CameraElement<double> {
    ShapedSurface<double, decltype(shape_of(Quadric<double>{}))> other;
    if constexpr (std::is_same_v<std::decay_t<decltype(held)>, ShapedSurface<double, Quadric<double>>>) {
      other.pose = held.pose;
      other.shape = shape_of(Quadric<double>{held.shape.curvature, -0.4});
      other.semi_diameter = held.semi_diameter;
      other.n_before = held.n_before;
      other.n_after = held.n_after;
    }
    return other;
  });
  return camera;
}

// The intersection with an asphere is found by iteration: the derivative is that of the converged solution.
TEST(TrainDerivatives, ThroughAnAsphereAreExact) {
  Camera const even = camera_with_last([](Quadric<double> const& conic) {
    return EvenAsphere<double>{conic, {0, 30.0, -4e4, 2e7}};
  });
  expect_exact_derivatives(even, static_cast<int>(even.elements.size()) - 1, off_axis);
  Camera const radial = camera_with_last([](Quadric<double> const& conic) {
    return RadialAsphere<double>{conic, 0.01, false, {0, 1e-6, 2e-6, 3e-7, -4e-8}};
  });
  expect_exact_derivatives(radial, static_cast<int>(radial.elements.size()) - 1, off_axis);
}

}  // namespace
}  // namespace gladstone
