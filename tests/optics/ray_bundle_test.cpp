#include "render/optics/ray_bundle.h"

#include <gtest/gtest.h>

namespace gladstone {
namespace {

// Rays that meet in (c, z0) cross the plane z = 0 at c - z0 s. Uniform slopes over a disc of radius r have a mean
// square of r^2 / 2; equal areas of the disc contain equal numbers of sunflower points, up to one in 500, which changes
// their mean by r/500.
TEST(RayBundle, IsNarrowestWhereItsRaysMeet) {
  double const z0 = 3e-3, r = 0.05;
  Vec2d const c{1e-3, -2e-3};
  std::vector<Vec2d> places, slopes;
  for (int k = 0; k < 500; ++k) {
    slopes.push_back(r * sunflower(k, 500) + Vec2d{0.1, 0});
    places.push_back(c - z0 * slopes.back());
  }
  BundleSpot<double> const spot = compute_bundle_spot(places, slopes);
  EXPECT_NEAR(spot.best_focus, z0, 1e-15);
  EXPECT_NEAR(spot.best_mean_square, 0, 1e-20);
  EXPECT_NEAR(spot.mean_square / (z0 * z0 * r * r / 2), 1, 2e-3);
  EXPECT_NEAR(spot.centroid.x, c.x - 0.1 * z0, 2e-3 * z0 * r);
  EXPECT_NEAR(spot.centroid.y, c.y, 2e-3 * z0 * r);
}

// A single ray, or parallel rays, have the same cross-section everywhere.
TEST(RayBundle, OfParallelRaysHasItsFocusOnThePlane) {
  BundleSpot<double> const spot = compute_bundle_spot<double>({{0, 0}, {2, 0}}, {{0.1, 0.2}, {0.1, 0.2}});
  EXPECT_EQ(spot.best_focus, 0);
  EXPECT_EQ(spot.mean_square, 1);
}

}  // namespace
}  // namespace gladstone
