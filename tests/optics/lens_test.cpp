#include "render/optics/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "render/optics/paraxial.h"
#include "tests/optics/lens_fixtures.h"

namespace gladstone {
namespace {

constexpr double flat = std::numeric_limits<double>::infinity();

/// @param options  an f-number of 1.9 lets the listing's marginal ray at f/2 pass despite rounding
Lens double_gauss(LensOptions const& options = {}) {
  Prescription prescription = read_prescription(GLADSTONE_DATA_DIR "/lenses/double_gauss.toml");
  double const wavelength = prescription.primary_wavelength;
  return build_lens(std::move(prescription), GlassCatalogue::shipped(), wavelength, options);
}

// Reference listing of the lens by the design program that contains it: focal length 100.0038, back focus 61.4875,
// front focus -29.3208, entrance pupil 50 at 57.9120, exit pupil 57.3201 at -53.1569; recomputed to more digits from
// its own indices.
TEST(DoubleGauss, HasThePublishedCardinalPoints) {
  ParaxialLens const paraxial = paraxial_lens(double_gauss());
  EXPECT_NEAR(paraxial.effective_focal_length * 1e3, 100.00375702793, 1e-9);
  EXPECT_NEAR(paraxial.back_focal_length * 1e3, 61.4875364179821, 1e-9);
  EXPECT_NEAR(paraxial.front_focal_length * 1e3, -29.3208, 5e-5);
  EXPECT_NEAR(paraxial.entrance.position * 1e3, 57.9120, 5e-5);
  EXPECT_NEAR(paraxial.entrance.diameter * 1e3, 50, 1e-9);
  EXPECT_NEAR(paraxial.exit.position * 1e3, -53.1569, 5e-5);
  EXPECT_NEAR(paraxial.exit.diameter * 1e3, 57.3201, 5e-5);
  EXPECT_NEAR(paraxial.f_number, 2.0, 1e-4);
}

// Real ray of the listing at a height of 25 mm: height, sag and slope behind every surface, printed to 1e-6 mm.
TEST(DoubleGauss, MarginalRayFollowsTheListing) {
  struct Row {
    double y, z, slope;
  };
  Row const listing[] = {
      {25.000000, 5.866433, -0.185302}, {24.109772, 1.920632, -0.200953}, {22.844992, 7.714534, -0.394267},
      {20.958242, 0, -0.395393},        {16.784894, 6.754936, -0.112583}, {15.702464, 0, -0.112583},
      {14.610682, -4.050377, 0.153430}, {15.815163, 0, 0.151784},         {16.882946, -3.965091, -0.057039},
      {16.583956, 0.776812, -0.071127}, {16.261006, -1.682704, -0.258832}};
  Lens const lens = double_gauss({.f_number = 1.9});
  Ray<double> ray = parallel_ray(25);
  for (int i = 0; i < lens.view().count; ++i) {
    RayAccount<double> account;
    int failed_at;
    ASSERT_EQ(lens.view().carry(ray, account, i, i + 1, failed_at), RayStatus::alive) << i;
    Vec3d const local = ray.position - lens.poses[static_cast<std::size_t>(i)].origin;
    EXPECT_NEAR(local.y * 1e3, listing[i].y, 6e-7) << i;
    EXPECT_NEAR(local.z * 1e3, listing[i].z, 6e-7) << i;
    EXPECT_NEAR(ray.direction.y / ray.direction.z, listing[i].slope, 6e-7) << i;
  }
}

// Transverse aberration of the listing on the axis in the image plane [mm].
TEST(DoubleGauss, AxialRaysMeetTheImageWhereTheListingSays) {
  Lens const lens = double_gauss({.f_number = 1.9});
  double const listing[][2] = {{25, 0.0141382}, {20, -0.0128508}, {15, 0.0079713}, {10, 0.0222848}, {5, 0.0176394}};
  for (auto const& [height, image] : listing) {
    Ray<double> ray = parallel_ray(height);
    ASSERT_EQ(carry(lens, ray), RayStatus::alive);
    EXPECT_NEAR(height_behind(lens, ray, *lens.image_distance * 1e3), image, 6e-8) << height;
  }
}

// Chief ray of the listing at 10 degrees: 17.485856 mm in the image plane. In front of the lens it is directed at a
// point of the axis 58.7753 mm behind the first vertex, farther than the paraxial pupil at 57.9120.
TEST(DoubleGauss, ChiefRayAtTenDegreesFollowsTheListing) {
  Lens const lens = double_gauss();
  double const angle = 10.0000000023 * unit::degree;
  RayOrigin const origin = RayOrigin::direction({0, std::sin(angle), std::cos(angle)});
  auto const disc = find_apparent_pupil(lens, origin);
  ASSERT_TRUE(disc);
  EXPECT_NEAR(-disc->centre.y / std::tan(angle) * 1e3, 58.7753, 5e-5);
  Ray<double> ray = origin.ray_through(disc->centre);
  ASSERT_EQ(carry(lens, ray), RayStatus::alive);
  EXPECT_NEAR(height_behind(lens, ray, *lens.image_distance * 1e3), 17.485856, 6e-7);
}

// Lens maker's formula of thick lenses: R = +-100, t = 10, n = 1.5168; a plano-convex lens; R = +-50, t = 20, n = 1.5
// (150 / 2.8); and a ball of 10 mm, n D / (4 (n - 1)).
TEST(ThickLens, HasTheFocalLengthsOfItsFormula) {
  auto const expect = [](std::vector<SurfaceMm> const& surfaces, double focal, double back) {
    ParaxialLens const p = paraxial_lens(lens_of(surfaces, 1));
    EXPECT_NEAR(p.effective_focal_length * 1e3, focal, 1e-12 * focal * 10);
    EXPECT_NEAR(p.back_focal_length * 1e3, back, 1e-12 * back * 10);
  };
  expect({{100, 10, 1.5168}, {-100, 0, 1}}, 98.4259980188549, 95.072453993529);
  expect({{51.5, 3.6, 1.5168}, {flat, 0, 1}}, 51.5 / 0.5168, 51.5 / 0.5168 - 3.6 / 1.5168);
  expect({{50, 20, 1.5}, {-50, 0, 1}}, 53.5714285714286, 46.4285714285714);
  expect({{5, 10, 1.5168}, {-5, 0, 1}}, 7.3374613003096, 7.3374613003096 - 5);
}

// Reversibility of light: a ray that is reversed behind the lens leaves the lens along the incoming ray.
TEST(Lens, RaysAreReversible) {
  Lens const lens = double_gauss();
  std::mt19937 engine(5);
  std::uniform_real_distribution<double> pick(-1, 1);
  for (int i = 0; i < 50; ++i) {
    Vec3d const start{0.012 * pick(engine), 0.012 * pick(engine), -0.1};
    Ray<double> const sent{start, normalized(Vec3d{0.05 * pick(engine), 0.05 * pick(engine), 1})};
    Ray<double> ray = sent;
    if (carry(lens, ray) != RayStatus::alive) continue;
    // the same surfaces from behind, with the indices exchanged
    ray.direction = -ray.direction;
    for (std::size_t k = lens.surfaces.size(); k-- > 0;) {
      RayAccount<double> account;
      ASSERT_EQ(lens.surfaces[k].visit([&](auto surface) {
        std::swap(surface.n_before, surface.n_after);
        return surface.interact(ray, account);
      }),
                RayStatus::alive);
    }
    double const way = (sent.position.z - ray.position.z) / ray.direction.z;
    EXPECT_LT(length(ray.position + way * ray.direction - sent.position), 1e-13);
    EXPECT_LT(length(ray.direction + sent.direction), 1e-12);
  }
}

// Fermat's principle: the optical path between two points is stationary at the traced ray, so that a first-order change
// of its intersection with a surface changes the path in second order only.
TEST(Lens, TracedPathIsStationary) {
  Lens const lens = lens_of({{60, 8, 1.6}, {-80, 5, 1}, {flat, 3, 1.5}, {120, 0, 1}}, 30);
  Ray<double> ray{{0.004, 0.009, -0.05}, normalized(Vec3d{0.03, -0.02, 1})};
  std::vector<Vec3d> met{ray.position};
  RayAccount<double> account;
  for (int i = 0; i < lens.view().count; ++i) {
    int failed_at;
    ASSERT_EQ(lens.view().carry(ray, account, i, i + 1, failed_at), RayStatus::alive);
    met.push_back(ray.position);
  }
  met.push_back(ray.position + 0.1 * ray.direction);
  double const indices[] = {1, 1.6, 1, 1.5, 1};
  auto const path = [&](std::vector<Vec3d> const& points) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) sum += indices[i] * length(points[i + 1] - points[i]);
    return sum;
  };
  EXPECT_NEAR(account.optical_path + 0.1, path(met), 1e-15);
  auto const moved = [&](std::size_t i, Vec2d by) {  // shifts the intersection with surface i along the surface
    std::vector<Vec3d> points = met;
    Vec3d& p = points[i + 1];
    p.x += by.x;
    p.y += by.y;
    double const vertex = lens.poses[i].origin.z;
    p.z = vertex + lens.surfaces[i].visit([&](auto const& surface) { return surface.shape.sag(p.x, p.y); });
    return path(points);
  };
  // error of the differences: slope h^2 / d^2, with d >= 3 mm between surfaces, and rounding of a path over h
  double const h = 3e-7;
  for (std::size_t i = 0; i < lens.surfaces.size(); ++i) {
    for (Vec2d const by : {Vec2d{h, 0}, Vec2d{0, h}}) {
      double const slope = (moved(i, by) - moved(i, -by)) / (2 * h);
      EXPECT_NEAR(slope, 0, 2e-9) << i;  // tolerance: 0.05 (1e-4)^2 + 5e-17 / 3e-7
    }
  }
}

// If its thickness and aperture shrink, a real lens images like a thin one: the error of the image height of a parallel
// ray decreases as the square of its height.
TEST(Lens, TendsToTheThinLensAsItShrinks) {
  double last = 0;
  for (double const height : {4.0, 2.0, 1.0}) {
    Lens const lens = lens_of({{100, 1e-6, 1.5}, {-100, 0, 1}}, 10);
    Ray<double> ray = parallel_ray(height);
    ASSERT_EQ(carry(lens, ray), RayStatus::alive);
    double const error = std::abs(ray.direction.y / ray.direction.z * 100 / height + 1);
    if (last > 0) {
      EXPECT_NEAR(last / error, 4, 0.02);
    }
    last = error;
  }
  EXPECT_LT(last, 5e-4);
}

// A plano-hyperbolic lens (k = -n^2 on the image side) focuses parallel light exactly, at any height: Descartes'
// surface.
TEST(Lens, DescartesHyperbolaIsStigmatic) {
  double const n = 1.5168;
  Lens const lens = lens_of({{flat, 5, n}, {-20, 0, 1, false, -n * n}}, 12);
  double const back = paraxial_lens(lens).back_focal_length * 1e3;
  EXPECT_NEAR(back, 20 / (n - 1), 1e-11);
  for (double const height : {1.0, 5.0, 11.0}) {
    Ray<double> ray = parallel_ray(height);
    ASSERT_EQ(carry(lens, ray), RayStatus::alive);
    EXPECT_NEAR(height_behind(lens, ray, back), 0, 1e-12 * 100);
  }
}

// The aplanatic points of a sphere (Born & Wolf, section 4.2.3): a point inside the ball at a distance R/n from the
// centre is imaged exactly to R n, and Abbe's sine condition is satisfied: sin u over sin u' is n for every ray.
TEST(Lens, AplanatObeysAbbesSineRule) {
  double const n = 1.6, radius = 0.010;
  ShapedSurface<double, Quadric<double>> ball;
  ball.shape = {-1 / radius};  // vertex at 0, centre at -R
  ball.semi_diameter = 1;
  ball.n_before = n;
  ball.n_after = 1;
  Vec3d const object{0, 0, -radius - radius / n};
  for (double const angle : {5.0, 20.0, 35.0}) {
    double const u = angle * unit::degree;
    Ray<double> ray{object, {0, std::sin(u), std::cos(u)}};
    RayAccount<double> account;
    ASSERT_EQ(ball.interact(ray, account), RayStatus::alive);
    double const crossing = ray.position.z - ray.position.y * ray.direction.z / ray.direction.y;
    EXPECT_NEAR(crossing, -radius - n * radius, 1e-15) << angle;
    EXPECT_NEAR(std::sin(u) / ray.direction.y, n, 1e-13) << angle;
  }
}

// Light that passes the stop can be lost at the edges of other surfaces: the surface is reported.
TEST(Lens, NamesTheSurfaceWhereARayIsLost) {
  Lens lens = lens_of({{50, 5, 1.5}, {-50, 10, 1}, {flat, 0, 1, true}}, 2);
  Ray<double> ray = parallel_ray(8);
  RayAccount<double> account;
  int failed_at = -1;
  EXPECT_EQ(lens.view().carry(ray, account, 0, lens.view().count, failed_at), RayStatus::vignetted);
  EXPECT_EQ(failed_at, 2);
  Ray<double> aside = parallel_ray(60);  // beyond the radius of the first sphere
  EXPECT_EQ(lens.view().carry(aside, account, 0, lens.view().count, failed_at), RayStatus::missed_lens);
  EXPECT_EQ(failed_at, 0);
}

}  // namespace
}  // namespace gladstone
