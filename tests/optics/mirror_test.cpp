#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/base/units.h"
#include "render/optics/camera_element.h"
#include "render/optics/lens_surface.h"
#include "render/optics/ray_bundle.h"
#include "tests/optics/lens_fixtures.h"

namespace gladstone {
namespace {

ShapedSurface<double, Quadric<double>> mirror_of(double radius, double conic, double along_y = 1) {
  ShapedSurface<double, Quadric<double>> mirror;
  mirror.shape = {1 / radius, conic, along_y};
  mirror.semi_diameter = std::numeric_limits<double>::infinity();
  mirror.action = SurfaceAction::reflect;
  return mirror;
}

/// Returns the distance from the axis at which a ray crosses a plane z = const [m].
double off_axis_at(Ray<double> const& ray, double z) {
  double const way = (z - ray.position.z) / ray.direction.z;
  return std::hypot(ray.position.x + way * ray.direction.x, ray.position.y + way * ray.direction.y);
}

// A flat mirror reflects rays along its normal back, and deflects a ray by twice its own tilt.
TEST(Mirror, FlatOneTurnsARayByTwiceItsTilt) {
  for (double const degrees : {0.0, 10.0, 45.0}) {
    auto mirror = mirror_of(std::numeric_limits<double>::infinity(), 0);
    mirror.pose = Pose<double>{{0, 0, 0.1}}.turned({degrees * unit::degree, 0, 0});
    Ray<double> ray{{0, 0, 0}, {0, 0, 1}};
    RayAccount<double> account;
    ASSERT_EQ(mirror.interact(ray, account), RayStatus::alive);
    double const turned = 2 * degrees * unit::degree;
    EXPECT_NEAR(length(ray.direction - Vec3d{0, std::sin(turned), -std::cos(turned)}), 0, 1e-15) << degrees;
    EXPECT_NEAR(account.optical_path, 0.1, 1e-15);
  }
}

// Light from one focus of an ellipsoid is reflected to the other one along paths of length 2 a. With semi-axis a and
// eccentricity e, the vertex has the radius a (1 - e^2) and k = -e^2; the foci are at a (1 - e) and a (1 + e) from it.
TEST(Mirror, EllipsoidImagesFocusToFocus) {
  double const a = 0.3, e = 0.6;
  auto const mirror = mirror_of(-a * (1 - e * e), -e * e);  // vertex at 0, concave towards -z
  Vec3d const near{0, 0, -a * (1 - e)}, far{0, 0, -a * (1 + e)};
  for (double const degrees : {1.0, 20.0, 50.0, 80.0}) {
    double const angle = degrees * unit::degree;
    Ray<double> ray{near, {std::sin(angle), 0, std::cos(angle)}};
    RayAccount<double> account;
    ASSERT_EQ(mirror.interact(ray, account), RayStatus::alive) << degrees;
    EXPECT_NEAR(off_axis_at(ray, far.z), 0, 1e-14) << degrees;
    EXPECT_NEAR(account.optical_path + length(far - ray.position), 2 * a, 1e-14) << degrees;
  }
}

// A ray parallel to the axis at height h = R sin(i) of a spherical mirror crosses the axis at R / (2 cos i) from the
// centre: at R/2 for paraxial rays, closer to the vertex by (R/2)(1 / cos i - 1), which is h^2 / (4 R) to lowest order.
TEST(Mirror, SphereHasItsLongitudinalAberration) {
  double const R = 0.2;
  auto const mirror = mirror_of(-R, 0);
  for (double const height : {1e-4, 0.01, 0.05, 0.1}) {
    Ray<double> ray{{0, height, -1}, {0, 0, 1}};
    RayAccount<double> account;
    ASSERT_EQ(mirror.interact(ray, account), RayStatus::alive);
    double const crossing = ray.position.z - ray.position.y * ray.direction.z / ray.direction.y;
    double const cosine = std::sqrt(1 - height * height / (R * R));
    // rounding of the height over the slope, 2 h / R
    EXPECT_NEAR(crossing, -R + R / (2 * cosine), 1e-16 * R / height * 10) << height;
  }
  Ray<double> ray{{0, 1e-4, -1}, {0, 0, 1}};
  RayAccount<double> account;
  mirror.interact(ray, account);
  double const crossing = ray.position.z - ray.position.y * ray.direction.z / ray.direction.y;
  EXPECT_NEAR(crossing, -R / 2, 1e-4 * 1e-4 / (4 * R) * 1.001);
}

// A parabolic cylinder focuses parallel light to a line: exactly in its focal plane across the axis of the cylinder,
// and not at all along it.
TEST(Mirror, ParabolicCylinderHasALineFocus) {
  double const f = 0.1;
  auto const mirror = mirror_of(-2 * f, -1, 0);
  for (Vec2d const at : {Vec2d{0.01, 0.02}, {0.05, -0.03}, {0.12, 0.08}}) {
    Ray<double> ray{{at.x, at.y, -1}, {0, 0, 1}};
    RayAccount<double> account;
    ASSERT_EQ(mirror.interact(ray, account), RayStatus::alive);
    double const way = (-f - ray.position.z) / ray.direction.z;
    EXPECT_NEAR(ray.position.x + way * ray.direction.x, 0, 1e-15);
    EXPECT_NEAR(ray.position.y + way * ray.direction.y, at.y, 1e-15);
  }
}

// In its plane of curvature, a cylindrical lens equals a spherical one. In the perpendicular plane it is a plane plate,
// which does not change a parallel ray.
TEST(Cylinder, RefractsLikeASphereAcrossAndLikeAPlateAlong) {
  auto const lens = [](double along_y) {
    ShapedSurface<double, Quadric<double>> front;
    front.semi_diameter = 1;
    front.shape = {1 / 0.05, 0, along_y};
    front.n_after = 1.5168;
    auto back = front;
    back.shape = {};
    back.pose.origin.z = 0.004;
    std::swap(back.n_before, back.n_after);
    return [front, back](Ray<double> ray) {
      RayAccount<double> account;
      EXPECT_EQ(front.interact(ray, account), RayStatus::alive);
      EXPECT_EQ(back.interact(ray, account), RayStatus::alive);
      return ray;
    };
  };
  for (double const height : {0.001, 0.005, 0.012}) {
    Ray<double> const across{{height, 0, -0.1}, {0, 0, 1}}, along{{0, height, -0.1}, {0, 0, 1}};
    Ray<double> const sphere = lens(1)(across), cylinder = lens(0)(across);
    EXPECT_NEAR(length(sphere.position - cylinder.position), 0, 1e-16);
    EXPECT_NEAR(length(sphere.direction - cylinder.direction), 0, 1e-15);
    Ray<double> const plate = lens(0)(along);
    EXPECT_EQ(plate.position.y, height);
    EXPECT_NEAR(length(plate.direction - Vec3d{0, 0, 1}), 0, 1e-16);
  }
  // for rays outside both planes, the light is still focused to the line: x at the focus is that for y = 0
  double const paraxial = 0.05 / 0.5168 - 0.004 / 1.5168 + 0.004;  // plano-convex, curved side first
  Ray<double> const one = lens(0)({{1e-5, 0, -0.1}, {0, 0, 1}}), other = lens(0)({{1e-5, 0.02, -0.1}, {0, 0, 1}});
  // aberration of the order of the cubed height over focal length: 1e-5 (1e-5 / 0.05)^2
  EXPECT_NEAR(one.position.x + (paraxial - one.position.z) * one.direction.x / one.direction.z, 0, 1e-12);
  EXPECT_NEAR(other.position.x - one.position.x, 0, 1e-18);
  EXPECT_EQ(other.position.y, 0.02);
}

// Two mirrors as a telescope (Cassegrain): a paraboloid and a hyperboloid with a common focus image parallel light to
// one point at any height. With f1 = 200, d = 150 and a magnification of the second mirror of m = 3: p = f1 - d = 50 in
// front of it, p' = m p = 150 behind it, R2 = -2 p p' / (p' - p), k2 = -((m + 1) / (m - 1))^2; the focal length is m f1
// = 600.
TEST(Mirror, CassegrainIsStigmaticAndAsLongAsItsFormulaSays) {
  Prescription prescription;
  prescription.file = "test";
  PrescribedSurface primary, secondary;
  primary.where = secondary.where = "test:1";
  primary.curvature = -1 / 0.4;
  primary.conic = -1;
  primary.thickness = -0.15;
  primary.after.is = PrescribedMedium::Mirror{};
  primary.stop = true;
  primary.semi_diameter = 0.05;
  secondary.curvature = -1 / (2 * 0.05 * 0.15 / (0.15 - 0.05));
  secondary.conic = -4;
  secondary.thickness = 0.15;
  secondary.after.is = PrescribedMedium::Mirror{};
  prescription.surfaces = {primary, secondary};
  Lens const lens = build_lens(prescription, GlassCatalogue::shipped(), spectral_line::d);
  ParaxialLens const paraxial = paraxial_lens(lens);
  EXPECT_NEAR(paraxial.effective_focal_length, 0.6, 1e-13);
  EXPECT_NEAR(paraxial.back_focal_length, 0.15, 1e-13);
  for (double const height : {5.0, 20.0, 49.0}) {
    Ray<double> ray{{0, height * 1e-3, -0.3}, {0, 0, 1}};
    RayAccount<double> account;
    ASSERT_EQ(carry(lens, ray, account), RayStatus::alive);
    double const way = (0.0 - ray.position.z) / ray.direction.z;  // the focus is in the vertex of the primary mirror
    EXPECT_NEAR(ray.position.y + way * ray.direction.y, 0, 1e-14) << height;
    EXPECT_NEAR(account.optical_path + way, 0.3 + 0.15 + 0.15, 1e-14) << height;
  }
}

// A stop transmits the share of a uniform beam that corresponds to its area. A plate of glass transmits 1 - ((n - 1)/(n
// + 1))^2 at either face, and exp(-a t) inside.
TEST(Energy, WeightsSumToTheTransmittedShare) {
  double const n = 1.5, absorption = 30, thickness = 0.005, radius = 0.004, beam = 0.01;
  PosedStop<double> const stop{{}, radius, 0};
  ShapedSurface<double, Quadric<double>> front, back;
  front.semi_diameter = back.semi_diameter = 1;
  front.pose.origin.z = 0.01;
  back.pose.origin.z = 0.01 + thickness;
  front.n_after = back.n_before = n;
  back.absorption = absorption;
  front.fresnel = back.fresnel = true;
  constexpr int rays = 20000;
  double passed = 0;
  for (int k = 0; k < rays; ++k) {
    Vec2d const at = beam * sunflower(k, rays);
    Ray<double> ray{{at.x, at.y, -0.1}, {0, 0, 1}};
    RayAccount<double> account;
    account.weight = 1.0 / rays;
    for (auto const& element : {CameraElement<double>(stop), {front}, {back}}) pass_element(element, ray, account);
    passed += account.weight;
  }
  double const face = 1 - std::pow((n - 1) / (n + 1), 2);
  double const expected = std::pow(radius / beam, 2) * face * face * std::exp(-absorption * thickness);
  // the number of sunflower points within a radius is that of the area, up to one
  EXPECT_NEAR(passed, expected, 1.5 / rays);
}

}  // namespace
}  // namespace gladstone
