#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <type_traits>

#include "render/base/units.h"
#include "render/optics/lens_surface.h"

namespace gladstone {
namespace {

using Flat = ShapedSurface<double, Quadric<double>>;

Flat plane(double z, double n_before, double n_after, Vec3d tilt = {}) {
  Flat surface;
  surface.pose = Pose<double>{{0, 0, z}}.turned(tilt);
  surface.semi_diameter = std::numeric_limits<double>::infinity();
  surface.n_before = n_before;
  surface.n_after = n_after;
  return surface;
}

Ray<double> ray_at(double angle) { return {{0, 0, -0.01}, {0, std::sin(angle), std::cos(angle)}}; }

// A plate of 10 mm, n = 1.5168: lateral shift t sin(i - i') / cos(i'), to all printed digits.
TEST(Refraction, PlaneParallelPlateShiftsARaySideways) {
  double const shifts[][2] = {
      {10, 0.601580184310577}, {30, 1.97621122205116}, {45, 3.34499391487284}, {60, 5.18297750549795}};
  for (auto const& [degrees, shift] : shifts) {
    double const angle = degrees * unit::degree;
    Ray<double> ray = ray_at(angle);
    Vec3d const start = ray.position, direction = ray.direction;
    RayAccount<double> account;
    ASSERT_EQ(plane(0, 1, 1.5168).interact(ray, account), RayStatus::alive);
    ASSERT_EQ(plane(0.01, 1.5168, 1).interact(ray, account), RayStatus::alive);
    EXPECT_LT(length(ray.direction - direction), 1e-15);
    Vec3d const aside = ray.position - start;
    EXPECT_NEAR(length(aside - dot(aside, direction) * direction) * 1e3, shift, 1e-13);
  }
}

// A prism of 60 degrees, n = 1.5168: deviation at three angles of incidence; the minimum is at 49.32 degrees.
TEST(Refraction, PrismDeviatesAsItsFormulaSays) {
  double const deviations[][2] = {{49.3233477362499, 38.6466954724999}, {40, 40.2742311354229}, {60, 40.1969846970311}};
  for (auto const& [incidence, deviation] : deviations) {
    // normals of the faces rotated by -+30 degrees; the ray meets the first face at the angle of incidence
    double const half = 30 * unit::degree;
    Flat const front = plane(0, 1, 1.5168, {half, 0, 0}), back = plane(0.02, 1.5168, 1, {-half, 0, 0});
    double const angle = incidence * unit::degree - half;  // above the axis
    Ray<double> ray{{0, 0, -0.01}, {0, std::sin(angle), std::cos(angle)}};
    RayAccount<double> account;
    ASSERT_EQ(front.interact(ray, account), RayStatus::alive);
    ASSERT_EQ(back.interact(ray, account), RayStatus::alive);
    double const turned = angle - std::atan2(ray.direction.y, ray.direction.z);
    EXPECT_NEAR(turned / unit::degree, deviation, 1e-11) << incidence;
  }
}

// Total internal reflection from glass of 1.5168 to air beyond 41.2451903696126 degrees.
TEST(Refraction, EndsAtTheCriticalAngle) {
  for (double const beside : {-1e-9, 1e-9}) {
    Ray<double> ray = ray_at(41.2451903696126 * unit::degree + beside);
    RayAccount<double> account;
    EXPECT_EQ(plane(0, 1.5168, 1).interact(ray, account),
              beside < 0 ? RayStatus::alive : RayStatus::total_internal_reflection);
  }
}

// Snell's law for both directions of light along z.
TEST(Refraction, TakesRaysOfAnyDirection) {
  Ray<double> ray{{0, 0, 0.01}, normalized(Vec3d{0.3, 0.1, -1})};
  double const sine = std::hypot(ray.direction.x, ray.direction.y);
  RayAccount<double> account;
  ASSERT_EQ(plane(0, 1.33, 1).interact(ray, account), RayStatus::alive);
  EXPECT_LT(ray.direction.z, 0);
  EXPECT_NEAR(std::hypot(ray.direction.x, ray.direction.y), 1.33 * sine, 1e-15);
  EXPECT_NEAR(length(ray.direction), 1, 1e-15);
}

// At normal incidence, an uncoated surface transmits 4 n / (n + 1)^2; at Brewster's angle, one polarisation is not
// reflected.
TEST(Fresnel, NormalIncidenceAndBrewster) {
  double const n = 1.5;
  EXPECT_NEAR(fresnel_transmittance(1.0, n, 1.0, 1.0), 4 * n / ((n + 1) * (n + 1)), 1e-15);
  double const brewster = std::atan(n), after = std::asin(std::sin(brewster) / n);
  double const s = std::pow((std::cos(brewster) - n * std::cos(after)) / (std::cos(brewster) + n * std::cos(after)), 2);
  EXPECT_NEAR(fresnel_transmittance(1.0, n, std::cos(brewster), std::cos(after)), 1 - s / 2, 1e-15);
}

// A parabolic mirror focuses parallel rays of any height.
TEST(Mirror, ParaboloidFocusesParallelRays) {
  Flat mirror;
  mirror.shape = {-1 / 0.2, -1};  // concave towards the light, focus 0.1 m in front of it
  mirror.semi_diameter = 1;
  mirror.action = SurfaceAction::reflect;
  for (double const height : {0.01, 0.05, 0.15}) {
    Ray<double> ray{{height, 0, -1}, {0, 0, 1}};
    RayAccount<double> account;
    ASSERT_EQ(mirror.interact(ray, account), RayStatus::alive);
    EXPECT_LT(ray.direction.z, 0);
    double const way = (-0.1 - ray.position.z) / ray.direction.z;
    EXPECT_NEAR(ray.position.x + way * ray.direction.x, 0, 1e-15);
    EXPECT_NEAR(account.optical_path + way, 1 + 0.1, 1e-15);  // as along the axis
  }
}

template <class Shape>
void expect_on_surface(Shape const& shape, double reach) {
  std::mt19937 engine(3);
  std::uniform_real_distribution<double> pick(-1, 1);
  for (int i = 0; i < 200; ++i) {
    Vec3d const from{2 * reach * pick(engine), 2 * reach * pick(engine), pick(engine)};
    Vec2d const to{reach * pick(engine), reach * pick(engine)};
    Vec3d const target{to.x, to.y, shape.sag(to.x, to.y)};
    Ray<double> const ray{from, normalized(target - from)};
    double way = 0;
    ASSERT_TRUE(shape.intersect(ray, way)) << i;
    Vec3d const met = ray.position + way * ray.direction;
    EXPECT_NEAR(met.z, shape.sag(met.x, met.y), 1e-14) << i;
    // the normal is perpendicular to the surface, whose tangents are computed by differences
    Vec3d const normal = shape.normal(met);
    double const h = 1e-6;
    Vec3d const along_x{2 * h, 0, shape.sag(met.x + h, met.y) - shape.sag(met.x - h, met.y)};
    Vec3d const along_y{0, 2 * h, shape.sag(met.x, met.y + h) - shape.sag(met.x, met.y - h)};
    EXPECT_NEAR(dot(normal, along_x) / (2 * h), 0, 1e-8);
    EXPECT_NEAR(dot(normal, along_y) / (2 * h), 0, 1e-8);
  }
}

TEST(Quadric, RaysEndOnTheSurfaceAndItsNormalIsAcross) {
  expect_on_surface(Quadric<double>{0.0}, 0.02);
  expect_on_surface(Quadric<double>{1 / 0.05}, 0.02);
  expect_on_surface(Quadric<double>{-1 / 0.05, -2.3}, 0.02);
  expect_on_surface(Quadric<double>{1 / 0.05, 0.7}, 0.02);
  expect_on_surface(Quadric<double>{1 / 0.03, 0.0, 0.0}, 0.02);  // a cylinder
}

TEST(EvenAsphere, RaysEndOnTheSurfaceAndItsNormalIsAcross) {
  expect_on_surface(EvenAsphere<double>{{1 / 0.05, -0.6}, {0, 3e3, -2e6, 1e9}}, 0.015);
  expect_on_surface(EvenAsphere<double>{{0, 0}, {2.0, -40.0}}, 0.015);
}

TEST(RadialAsphere, RaysEndOnTheSurfaceAndItsNormalIsAcross) {
  expect_on_surface(RadialAsphere<double>{{1 / 0.05, -0.6}, 0.01, true, {0, 3e-5, -2e-6, 1e-6}}, 0.015);
  expect_on_surface(RadialAsphere<double>{{1 / 0.05, -0.6}, 0.01, false, {0, 1e-5, 3e-5, -2e-6, 1e-6}}, 0.015);
  expect_on_surface(RadialAsphere<double>{{0, 0}, 0.01, false, {0, 0, 1e-4}}, 0.015);
}

// Terms of r^2, r^4, ... with a normalisation radius of 10 mm equal those of an even asphere times its powers; if all
// powers are allowed, the even ones describe the same surface.
TEST(RadialAsphere, OfEvenPowersIsTheEvenAsphere) {
  Quadric<double> const conic{1 / 0.05, -0.6};
  EvenAsphere<double> const even{conic, {2.0, 3e3, -2e6}};
  RadialAsphere<double> const scaled{conic, 0.01, true, {2e-4, 3e-5, -2e-6}};
  RadialAsphere<double> const all{conic, 0.01, false, {0, 2e-4, 0, 3e-5, 0, -2e-6}};
  for (Vec2d const p : {Vec2d{0, 0}, {0.001, 0.002}, {0.01, -0.004}}) {
    double const sag = even.sag(p.x, p.y);
    EXPECT_NEAR(scaled.sag(p.x, p.y), sag, 1e-17);
    EXPECT_NEAR(all.sag(p.x, p.y), sag, 1e-17);
    EXPECT_LT(length(scaled.normal({p.x, p.y, sag}) - even.normal({p.x, p.y, sag})), 1e-15);
    EXPECT_LT(length(all.normal({p.x, p.y, sag}) - even.normal({p.x, p.y, sag})), 1e-15);
  }
  // 20 of the conic and 2 x 2 of the polynomial. The sum is rounded by 2e-15, and four operations by 4e-16 each.
  for (double const curvature : {even.vertex_curvature(), scaled.vertex_curvature(), all.vertex_curvature()})
    EXPECT_NEAR(curvature, 24.0, 1e-14);
}

TEST(TiltedPlane, RaysEndOnTheSurfaceAndItsNormalIsAcross) {
  expect_on_surface(TiltedPlane<double>{{0.1, -0.3}}, 0.02);
  double way;
  EXPECT_FALSE((TiltedPlane<double>{{1, 0}}.intersect({{0, 0, 1}, normalized(Vec3d{1, 0, 1})}, way)));  // along it
}

// Lens surfaces are copied to a device as bytes.
static_assert(std::is_trivially_copyable_v<LensSurface<double>>);

// A sphere written as an asphere: the first term of its sag is r^2 / 2R, which the conic represents.
TEST(EvenAsphere, WithoutTermsIsItsConic) {
  Quadric<double> const sphere{1 / 0.04};
  EvenAsphere<double> const same{sphere, {}};
  Ray<double> const ray{{0.001, -0.002, -0.1}, normalized(Vec3d{0.05, 0.07, 1})};
  double one = 0, other = 0;
  ASSERT_TRUE(sphere.intersect(ray, one) && same.intersect(ray, other));
  EXPECT_NEAR(one, other, 1e-16);
}

// The far side of a sphere is not part of the surface: rays that pass outside the sheet through the vertex miss it.
TEST(Quadric, IsMissedBesideItsSheet) {
  Quadric<double> const sphere{1 / 0.01};
  double way;
  EXPECT_FALSE(sphere.intersect({{0.0101, 0, -1}, {0, 0, 1}}, way));
  EXPECT_TRUE(sphere.intersect({{0.0099, 0, -1}, {0, 0, 1}}, way));
  EXPECT_NEAR(way, 1 + 0.01 - std::sqrt(0.01 * 0.01 - 0.0099 * 0.0099), 1e-15);
}

}  // namespace
}  // namespace gladstone
