#include "render/rays/aimed_sources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "render/base/units.h"

namespace gladstone {
namespace {

constexpr double pupil_radius = 5e-3, pupil_z = 0.75, target_z = -0.25;

/// Returns a bundle of rays towards a pupil of 5 mm radius, 1 m from the target.
AimedBundle<double> towards_pupil(PupilSampling sampling, double radius = pupil_radius) {
  AimedBundle<double> aimed{
      {0, 0, pupil_z}, {radius, 0, 0}, {0, radius, 0}, {}, {.seed = 11, .sampling = sampling}, {}, {}};
  aimed.across = {0, 0, pi * radius * radius};
  return aimed;
}

LambertSources<double> source_at(Vec2d const& centre, double half_size, SourceShape shape = SourceShape::disc) {
  return {{&centre, nullptr, 1, target_z, half_size, shape}};
}

/// Returns the intersection of a ray with the plane of the pupil [m].
Vec2d at_pupil(Ray<double> const& ray) {
  double const way = (pupil_z - ray.position.z) / ray.direction.z;
  return {ray.position.x + way * ray.direction.x, ray.position.y + way * ray.direction.y};
}

/// Returns the index of the cell that contains a point of a disc, for rings x sectors cells of equal area.
int equal_area_cell(Vec2d p, double radius, int rings, int sectors) {
  double const r2 = dot(p, p) / (radius * radius);
  double turn = std::atan2(p.y, p.x) / (2 * pi);
  if (turn < 0) turn += 1;
  return std::min(static_cast<int>(r2 * rings), rings - 1) * sectors +
         std::min(static_cast<int>(turn * sectors), sectors - 1);
}

// Cells of equal area of the disc are elementary intervals of (radius^2, angle), so a net fills all of them equally.
// Pairs of opposite points do so too, since a rotation by 180 degrees maps every cell to another one.
TEST(AimedSources, SobolPointsFillCellsOfEqualAreaEqually) {
  Vec2d const centre{1e-3, -2e-3};
  LambertSources<double> const source = source_at(centre, 1e-4);
  std::map<int, int> pupil, disc;
  for (std::uint64_t j = 0; j < 4096; ++j) {
    Ray<double> const ray = aim_ray(source, towards_pupil(PupilSampling::sobol), 0, j).ray;
    ASSERT_LE(length(at_pupil(ray)), pupil_radius);
    Vec2d const on_disc = Vec2d{ray.position.x, ray.position.y} - centre;
    ASSERT_LE(length(on_disc), 1e-4 * (1 + 1e-9));
    ++pupil[equal_area_cell(at_pupil(ray), pupil_radius, 8, 8)];
    ++disc[equal_area_cell(on_disc, 1e-4, 8, 8)];
  }
  ASSERT_EQ(pupil.size(), 64u);
  ASSERT_EQ(disc.size(), 64u);
  for (auto const& [cell, count] : pupil) EXPECT_EQ(count, 64) << cell;
  for (auto const& [cell, count] : disc) EXPECT_EQ(count, 64) << cell;
}

// The order of the points changes the order of the rays only: each scrambling has the same rays, to the bit, as in the
// order of the sequence. With 77 rays in 8 scramblings some points have one ray, and some scramblings one point more.
TEST(AimedSources, OrderedRaysAreThoseOfTheSequence) {
  Vec2d const centre{1e-3, -2e-3};
  LambertSources<double> const source = source_at(centre, 1e-4);
  for (std::uint64_t const rays : {5u, 77u, 1000u, 10000u}) {
    AimedBundle<double> bundle = towards_pupil(PupilSampling::sobol);
    bundle.choice.scrambling_bits = scrambling_bits(rays);
    auto const sorted_rays = [&] {
      std::vector<std::array<double, 6>> sorted;
      for (std::uint64_t j = 0; j < rays; ++j) {
        AimedRay<double> const aimed = aim_ray(source, bundle, 0, j);
        double const scrambling = static_cast<double>(j % (1u << bundle.choice.scrambling_bits));
        sorted.push_back({scrambling, aimed.ray.position.x, aimed.ray.position.y, aimed.ray.direction.x,
                          aimed.ray.direction.y, aimed.weight});
      }
      std::sort(sorted.begin(), sorted.end());
      return sorted;
    };
    auto const in_sequence = sorted_rays();
    bundle.choice.ordered_points = complete_points(rays, bundle.choice.scrambling_bits);
    EXPECT_EQ(sorted_rays(), in_sequence) << rays;
  }
}

// The rays of one place of the order, two of each of four scramblings, run to points within a sector of 1/1024 of the
// pupil's area: 1/64 of a turn by 1/16 of the squared radius.
TEST(AimedSources, OrderedRaysStayTogether) {
  Vec2d const centre{1e-3, -2e-3};
  LambertSources<double> const source = source_at(centre, 1e-4);
  AimedBundle<double> bundle = towards_pupil(PupilSampling::sobol);
  bundle.choice.scrambling_bits = 2;
  bundle.choice.ordered_points = 1024;
  for (std::uint64_t first = 0; first < 8192; first += 8) {
    double least2 = 1, most2 = 0;
    Vec2d const p = at_pupil(aim_ray(source, bundle, 0, first).ray) / pupil_radius;
    for (std::uint64_t j = first; j < first + 8; ++j) {
      Vec2d const q = at_pupil(aim_ray(source, bundle, 0, j).ray) / pupil_radius;
      least2 = std::min(least2, dot(q, q));
      most2 = std::max(most2, dot(q, q));
      double const turn = std::atan2(p.x * q.y - p.y * q.x, dot(p, q)) / (2 * pi);
      ASSERT_LE(std::abs(turn), 1.0 / 64 + 1e-9) << j;
    }
    ASSERT_LE(most2 - least2, 1.0 / 16 + 1e-9) << first;
  }
}

// For a uniform disc of radius R: <x> = <y> = <x y> = 0, <x^2> = <y^2> = R^2/4, <x^4> = R^4/8. The variances of these
// averages per point are R^2/4, R^4/24, R^4/8 - R^4/16 and R^8 (7/128 - 1/64) (moments of cos^2p and r^2p). Tolerance:
// five standard errors. Rays 2 k and 2 k + 1 share their pupil point, so only every second ray is counted.
TEST(AimedSources, RandomPupilPointsHaveTheMomentsOfADisc) {
  Vec2d const centre{};
  LambertSources<double> const source = source_at(centre, 0);
  constexpr int n = 20000;
  double x = 0, y = 0, xy = 0, xx = 0, yy = 0, x4 = 0;
  for (std::uint64_t k = 0; k < n; ++k) {
    Ray<double> const ray = aim_ray(source, towards_pupil(PupilSampling::random), 0, 2 * k).ray;
    ASSERT_EQ(ray.position, (Vec3d{0, 0, target_z}));
    Vec2d const p = at_pupil(ray) / pupil_radius;
    x += p.x / n, y += p.y / n, xy += p.x * p.y / n, xx += p.x * p.x / n, yy += p.y * p.y / n;
    x4 += p.x * p.x * p.x * p.x / n;
  }
  EXPECT_NEAR(x, 0, 5 * std::sqrt(1.0 / 4 / n));
  EXPECT_NEAR(y, 0, 5 * std::sqrt(1.0 / 4 / n));
  EXPECT_NEAR(xy, 0, 5 * std::sqrt(1.0 / 24 / n));
  EXPECT_NEAR(xx, 0.25, 5 * std::sqrt(1.0 / 16 / n));
  EXPECT_NEAR(yy, 0.25, 5 * std::sqrt(1.0 / 16 / n));
  EXPECT_NEAR(x4, 0.125, 5 * std::sqrt((7.0 / 128 - 1.0 / 64) / n));
}

// A Lambertian source of radiance L emits the flux L A cos^4 / D^2 per unit area into a pupil of area A at the distance
// D along the axis. The factor cos^4 is the product of the cosine at the source, the cosine at the pupil, and cos^2
// from the squared distance. Tolerance: about ten rounding errors of 1.1e-16.
TEST(AimedSources, RaysRunToTheirPupilPointWithWeightRadianceCosFour) {
  Vec2d const centres[] = {{0, 0}, {0.02, -0.03}};
  double const radiance[] = {1.0, 0.25};
  LambertSources<double> const sources{{centres, radiance, 2, target_z, 2e-4, SourceShape::disc}};
  Vec2d const place{0.3, -0.6};
  for (std::uint64_t source = 0; source < 2; ++source) {
    for (int k = 0; k < 50; ++k) {
      Vec2d const to = point_on_circle(std::sqrt((k + 0.5) / 50), 0.381966 * k);
      auto const [ray, weight] = ray_to(sources, towards_pupil(PupilSampling::sobol), source, place, to);
      Vec2d const start = centres[source] + 2e-4 * place, pupil = pupil_radius * to;
      EXPECT_EQ(ray.position, (Vec3d{start.x, start.y, target_z}));
      EXPECT_NEAR(length(ray.direction), 1, 1e-15);
      EXPECT_NEAR(at_pupil(ray).x, pupil.x, 1e-16);
      EXPECT_NEAR(at_pupil(ray).y, pupil.y, 1e-16);
      double const cosine = 1 / std::hypot(length(pupil - start), 1.0);
      EXPECT_NEAR(weight / (pi * pupil_radius * pupil_radius), radiance[source] * std::pow(cosine, 4), 2e-15);
    }
  }
}

TEST(AimedSources, ChiefRaysAllCrossThePupilsCentre) {
  Vec2d const centre{0.01, 0.0};
  LambertSources<double> const source = source_at(centre, 2e-4);
  for (std::uint64_t j = 0; j < 50; ++j) {
    EXPECT_LT(length(at_pupil(aim_ray(source, towards_pupil(PupilSampling::sobol, 0), 0, j).ray)), 1e-17);
  }
}

// Eight by eight squares of a square source are elementary intervals of its pair of dimensions.
TEST(AimedSources, SquareSourcesAreFilledEvenly) {
  Vec2d const centre{};
  LambertSources<double> const source = source_at(centre, 1.0, SourceShape::square);
  std::map<std::pair<int, int>, int> counts;
  for (std::uint64_t j = 0; j < 4096; ++j) {
    Vec3d const p = aim_ray(source, towards_pupil(PupilSampling::sobol), 0, j).ray.position;
    ++counts[{static_cast<int>(std::floor(4 * p.x)), static_cast<int>(std::floor(4 * p.y))}];
  }
  ASSERT_EQ(counts.size(), 64u);
  for (auto const& [cell, count] : counts) {
    EXPECT_EQ(count, 64);
    EXPECT_TRUE(cell.first >= -4 && cell.first < 4 && cell.second >= -4 && cell.second < 4);
  }
}

}  // namespace
}  // namespace gladstone
