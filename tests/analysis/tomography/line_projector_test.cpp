#include "analysis/tomography/line_projector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "tests/analysis/tomography/phantom_views.h"

namespace gladstone::inline tomography {
namespace {

double dot_product(std::vector<double> const& a, std::vector<double> const& b) {
  return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Oblique lines, some of which cross a volume and some of which miss it, from a pupil 0.4 m in front of it.
std::vector<SightLine> make_fan() {
  std::vector<SightLine> lines;
  Vec3d const pupil{0.05, -0.02, 0.4};
  for (int i = -6; i <= 6; ++i)
    for (int j = -6; j <= 6; ++j) {
      SightLine line;
      line.origin = {3e-3 * i, 2.5e-3 * j, -0.25};
      line.pupil_distance = length(pupil - line.origin);
      line.direction = (pupil - line.origin) / line.pupil_distance;
      line.scale = 1.6;
      lines.push_back(line);
    }
  return lines;
}

// The integral of exp(-r^2 / R^2) along a line at the distance d from the centre is sqrt(pi) R exp(-d^2 / R^2). The
// trilinear interpolation errs by h^2 / 8 times the second derivatives: halving the spacing divides the error by 4.
TEST(LineProjector, IntegralOfAGaussianBlobConvergesWithSecondOrder) {
  double const radius = 4e-3;
  double previous = 0.0;
  for (int nodes : {25, 49, 97}) {
    RegularGrid const grid = make_cube(nodes, 24e-3);
    std::vector<double> const blob = sample_blob(grid, radius);
    std::vector<SightLine> lines;
    for (int i = -5; i <= 5; ++i) {
      SightLine line;
      line.direction = normalized(Vec3d{0.3, -0.2, 1.0});
      line.origin = Vec3d{1.1e-3 * i, 0.4e-3 * i, -0.2} + 0.2 * Vec3d{-0.3, 0.2, 0.0};
      lines.push_back(line);
    }
    std::vector<double> const projected = LineProjector(grid, lines).project(blob);
    double squares = 0.0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      Vec3d const a = lines[i].origin, d = lines[i].direction;
      double const miss = length(a - dot(a, d) * d);
      double const exact = std::sqrt(M_PI) * radius * std::exp(-miss * miss / (radius * radius));
      squares += (projected[i] - exact) * (projected[i] - exact);
    }
    double const error = std::sqrt(squares);
    if (previous > 0.0) {
      EXPECT_NEAR(previous / error, 4.0, 0.4);  // the next term of the error is of order h^4
    }
    previous = error;
  }
}

// The midpoint rule and the trilinear interpolation are exact for affine densities: the integral is the length of the
// chord times the density in its middle.
TEST(LineProjector, AffineDensityIsExact) {
  RegularGrid const grid = make_cube(9, 16e-3);
  std::vector<double> affine;
  visit_cube(grid, [&](Vec3d p) { affine.push_back(1.2 + 30.0 * p.x - 20.0 * p.y + 50.0 * p.z); });
  SightLine line;
  line.direction = normalized(Vec3d{0.2, 0.1, 1.0});
  line.origin = {1e-3, -2e-3, 0.0};
  double const chord = 16e-3 / line.direction.z;  // from face to face along z
  std::vector<SightLine> const lines{line};
  LineProjector const projector(grid, lines);
  EXPECT_NEAR(projector.row_sums()[0], chord, 1e-12 * chord);
  double const middle = 1.2 + 30.0 * line.origin.x - 20.0 * line.origin.y;
  EXPECT_NEAR(projector.project(affine)[0], chord * middle, 1e-12 * chord * middle);
}

// A' is the adjoint of A: <A x, y> = <x, A' y> for any x and y, up to rounding.
TEST(LineProjector, BackProjectionIsTheAdjoint) {
  RegularGrid const grid = make_cube(13, 24e-3);
  std::vector<SightLine> const lines = make_fan();
  std::vector<double> x(grid.size()), y(lines.size());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(1.7 * static_cast<double>(i));
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = std::cos(2.3 * static_cast<double>(i));
  LineProjector const projector(grid, lines);
  std::vector<NodeSum> sums;
  projector.back_project(y, sums);
  std::vector<double> transposed(x.size()), weights(x.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    transposed[i] = sums[i].value;
    weights[i] = sums[i].weight;
  }
  double const left = dot_product(projector.project(x), y), right = dot_product(x, transposed);
  EXPECT_NEAR(left, right, 1e-12 * (std::abs(left) + 1e-3));
  EXPECT_NE(left, 0.0);
  // A' 1 and A 1 have the same sum
  EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0),
              std::accumulate(projector.row_sums().begin(), projector.row_sums().end(), 0.0), 1e-12);
}

// Along each line the weight is scale s / (B - s): for a uniform density on the chord [a, b] the integral is
// scale (B ln((B - a) / (B - b)) - (b - a)).
TEST(LineProjector, DensityIsWeightedByDotDistanceOverPupilDistance) {
  RegularGrid const grid = make_cube(33, 32e-3);
  SightLine line;
  line.origin = {0.0, 0.0, -0.25};
  line.direction = {0.0, 0.0, 1.0};
  line.pupil_distance = 1.0;
  line.scale = 3.0;
  std::vector<SightLine> const lines{line};
  double const a = 0.234, b = 0.266;
  double const exact = 3.0 * (std::log((1.0 - a) / (1.0 - b)) - (b - a));
  // midpoint rule of step h = 0.5 mm: relative error h^2 / 24 f'' / f < 1e-6 for f = s / (1 - s)
  EXPECT_NEAR(LineProjector(grid, lines).row_sums()[0], exact, 1e-6 * exact);
  EXPECT_DOUBLE_EQ(line.weight(0.25), 1.0);
}

TEST(LineProjector, IgnoresValuesThatAreNotFiniteAndLinesBesideTheVolume) {
  RegularGrid const grid = make_cube(5, 4e-3);
  SightLine through, beside;
  through.direction = beside.direction = {0.0, 0.0, 1.0};
  beside.origin = {5e-3, 0.0, 0.0};
  std::vector<SightLine> const lines{through, beside};
  LineProjector const projector(grid, lines);
  EXPECT_EQ(projector.row_sums()[1], 0.0);
  std::vector<NodeSum> sums;
  projector.back_project(std::vector<double>{not_a_number, 1.0}, sums);
  for (NodeSum const& sum : sums) EXPECT_EQ(sum.weight, 0.0);
}

// The order of all sums is fixed, so that the number of threads changes no bit.
TEST(LineProjector, GatheringAtANodeEqualsTheBackProjection) {
  RegularGrid const grid{{9, 12, 7}, {2e-3, 2.5e-3, 3e-3}, {-8e-3, -13e-3, -9e-3}};
  std::vector<SightLine> lines = make_fan();
  for (int i = 0; i < 5; ++i) {  // parallel lines along an axis: in planes of nodes, and between them
    SightLine line;
    line.origin = {-8e-3 + 1e-3 * i, -3e-3, 0.0};
    line.direction = {0.0, 0.0, 1.0};
    lines.push_back(line);
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < lines.size(); ++i) values.push_back(std::sin(1.0 + static_cast<double>(i)));
  std::vector<NodeSum> scattered;
  LineProjector(grid, lines).back_project(values, scattered);
  VolumeShape const shape = VolumeShape::of(grid);
  std::size_t node = 0;
  int seen = 0;
  for (int k = 0; k < grid.nodes[2]; ++k)
    for (int j = 0; j < grid.nodes[1]; ++j)
      for (int i = 0; i < grid.nodes[0]; ++i, ++node) {
        int const at[3] = {i, j, k};
        NodeSum gathered;
        for (std::size_t line = 0; line < lines.size(); ++line)
          visit_node(shape, lines[line], LineSamples::of(shape, lines[line]), at,
                     [&](double weight) { gathered.add(weight, values[line]); });
        // Both sums add the same products in the same order, up to the rounding of fused operations: fewer than 40
        // contributions, each with 1e-16 of the sum
        ASSERT_NEAR(gathered.value, scattered[node].value, 5e-15 * scattered[node].weight) << node;
        ASSERT_NEAR(gathered.weight, scattered[node].weight, 5e-15 * scattered[node].weight) << node;
        seen += gathered.weight > 0.0 ? 1 : 0;
      }
  EXPECT_GT(seen, 50);
}

TEST(LineProjector, ResultDoesNotDependOnTheNumberOfThreads) {
  RegularGrid const grid = make_cube(13, 24e-3);
  std::vector<SightLine> const lines = make_fan();
  std::vector<double> x(grid.size(), 1.0 / 3.0), y(lines.size(), 0.1);
  auto const compute = [&](int threads) {
    set_thread_count(threads);
    LineProjector const projector(grid, lines);
    std::vector<double> all = projector.project(x);
    std::vector<NodeSum> sums;
    projector.back_project(y, sums);
    for (NodeSum const& sum : sums) all.insert(all.end(), {sum.value, sum.weight});
    return all;
  };
  std::vector<double> const one = compute(1), three = compute(3);
  set_thread_count(0);
  EXPECT_EQ(one, three);
}

}  // namespace
}  // namespace gladstone::inline tomography
