#include <gtest/gtest.h>

#include <cmath>

#include "render/medium/trace_medium.h"
#include "tests/support/gridded.h"

namespace gladstone {
namespace {

using test::open_grid;
using test::sampled;

/// Rays with different paths in a cube from 0 to 8 m: through it, out of its side between two steps, past it, and from
/// inside it.
constexpr int count = 4;
Ray<double> ray_number(int i) {
  Ray<double> const rays[count] = {{{3.1, 4.2, -2}, normalized(Vec3d{0.05, -0.02, 1})},
                                   {{6.5, 4.0, -2}, normalized(Vec3d{0.45, 0.1, 1})},
                                   {{9.0, 4.0, -2}, {0, 0, 1}},
                                   {{4.0, 3.0, 2.5}, normalized(Vec3d{-0.1, 0.2, 1})}};
  return rays[i];
}

// A ray takes the same steps in a group as alone. The tolerance is three times the rounding of 30 steps: lengths of 10
// m and directions of 1 to 30 x 2.2e-16 of them.
void expect_equal_to_single_rays(TracingOptions<double> const& options, int const (&which)[2]) {
  auto const volume = sampled<float>(open_grid(9, 9, 9), [](Vec3d p) {
    return 1e-3 * (std::sin(0.7 * p.x + 0.1) * std::cos(0.5 * p.y - 0.4) + 0.3 * std::sin(0.9 * p.z + p.x));
  });
  auto const medium = volume.view<double, CubicBspline, 3>(0, 0);
  Ray<double> const start[2] = {ray_number(which[0]), ray_number(which[1])};
  MediumPassage<double> together[2];
  trace_medium(medium, options, start, together);
  for (int i = 0; i < 2; ++i) {
    MediumPassage<double> const alone = trace_medium(medium, options, start[i]);
    EXPECT_EQ(together[i].status, alone.status);
    EXPECT_EQ(together[i].crossed, alone.crossed);
    EXPECT_NEAR(together[i].t, alone.t, 2e-13);
    EXPECT_NEAR(together[i].optical_path, alone.optical_path, 2e-13);
    EXPECT_LT(length(together[i].shift - alone.shift), 2e-13);
    EXPECT_LT(length(together[i].turn - alone.turn), 2e-14);
  }
}

TEST(TraceTogether, GivesWhatSingleRaysGive) {
  for (Integrator const integrator : {Integrator::rk4, Integrator::euler, Integrator::straight}) {
    for (Faces const faces : {Faces::matched, Faces::refract}) {
      TracingOptions<double> options;
      options.step = 0.3;
      options.ambient_refractivity = 2e-4;
      options.integrator = integrator;
      options.faces = faces;
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) expect_equal_to_single_rays(options, {i, j});
      }
    }
  }
}

// The medium deflects these rays noticeably, so that the comparison above is meaningful.
TEST(TraceTogether, BendsItsRays) {
  auto const volume = sampled<float>(open_grid(9, 9, 9), [](Vec3d p) { return 1e-3 * std::sin(0.7 * p.x); });
  auto const medium = volume.view<double, CubicBspline, 3>(0, 0);
  TracingOptions<double> options;
  options.step = 0.3;
  Ray<double> const start[2] = {ray_number(0), ray_number(3)};
  MediumPassage<double> way[2];
  trace_medium(medium, options, start, way);
  EXPECT_GT(std::abs(way[0].turn.x), 1e-4);
  EXPECT_GT(std::abs(way[1].turn.x), 1e-4);
}

}  // namespace
}  // namespace gladstone
