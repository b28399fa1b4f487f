#include "render/medium/cell_polynomials.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/medium/trace_medium.h"
#include "tests/support/gridded.h"

namespace gladstone {
namespace {

using test::open_grid;
using test::sampled;

/// A field without symmetry that is smooth over several cells of a unit grid.
double rough(Vec3d p) {
  return 1e-4 * (std::sin(0.7 * p.x + 0.1) * std::cos(0.5 * p.y - 0.4) + 0.3 * std::sin(0.9 * p.z + p.x));
}

/// Polynomials of a grid together with their memory.
template <class Basis>
struct Owned {
  template <class Grid>
  explicit Owned(Grid const& grid) {
    using Cells = CellPolynomials<Basis, true>;
    Cells const shape(grid, nullptr);
    values.resize(shape.cell_count() * Cells::size);
    double* out = values.data();
    for (int k = 0; k < shape.cells[2]; ++k) {
      for (int j = 0; j < shape.cells[1]; ++j) {
        for (int i = 0; i < shape.cells[0]; ++i, out += Cells::size) fill_cell(grid, i, j, k, out);
      }
    }
    view = Cells(grid, values.data());
  }
  std::vector<double> values;
  CellPolynomials<Basis, true> view;
};

/// Returns positions in a box of 7 x 6 x 5 cells and on its faces, on the nodes and between them.
std::vector<Vec3d> places() {
  std::vector<Vec3d> all;
  for (double x = 0; x <= 7; x += 0.875) {
    for (double y = 0; y <= 6; y += 0.6) {
      for (double z = 0; z <= 5; z += 0.3125) all.push_back({x, y, z});
    }
  }
  return all;
}

// Both representations are the same polynomial. Its coefficients are below 1e-3 (a field of 1.3e-4, differenced three
// times in three directions); there are 64 of them, with about ten roundings of 1.1e-16 each.
template <class Basis, class Grid>
void expect_same(Grid const& grid) {
  double const tolerance = 64 * 1e-3 * 10 * 1.1e-16;
  Owned<Basis> const cells(grid);
  CellPolynomials<Basis, false> const open(grid, cells.values.data());
  bool const repeats = grid.periodic[0] || grid.periodic[1] || grid.periodic[2];
  for (Vec3d const p : places()) {
    IndexSample<double> const a = grid.sample(p), b = cells.view.sample(p);
    EXPECT_NEAR(a.refractivity, b.refractivity, tolerance);
    if (!repeats) {
      EXPECT_EQ(b.refractivity, open.sample(p).refractivity);
    }
    // at the nodes, the slope of a linear field is that of either neighbouring cell
    if (Basis::support == 2 && (p.x == std::floor(p.x) || p.y == std::floor(p.y) || p.z == std::floor(p.z))) continue;
    EXPECT_LT(length(a.gradient - b.gradient), tolerance);
  }
}

TEST(CellPolynomials, EqualTheInterpolationOfTheGrid) {
  auto const spline = sampled<float>(open_grid(8, 7, 6), rough);
  expect_same<CubicBspline>(spline.view<double, CubicBspline, 3>(0, 0));
  auto const linear = sampled<float>(open_grid(8, 7, 6), rough, false);
  expect_same<Linear>(linear.view<double, Linear, 3>(0, 0));
}

// Nodes at 2 + 0.5 i and so on: slopes are proportional to 1/spacing.
TEST(CellPolynomials, CountInMetres) {
  auto const volume = sampled<float>(open_grid(8, 7, 6, {0.5, 0.25, 2}, {2, -1, 3}), rough);
  auto const grid = volume.view<double, CubicBspline, 3>(0, 0);
  Owned<CubicBspline> const cells(grid);
  for (Vec3d const p : {Vec3d{2.1, -0.9, 3.5}, Vec3d{5.4, 0.45, 12.9}, Vec3d{3.5, 0.25, 7}}) {
    IndexSample<double> const a = grid.sample(p), b = cells.view.sample(p);
    EXPECT_NEAR(a.refractivity, b.refractivity, 7e-17);
    EXPECT_LT(length(a.gradient - b.gradient), 4 * 7e-17);
  }
}

TEST(CellPolynomials, RepeatWhereTheGridDoes) {
  RegularGrid shape = open_grid(7, 6, 5);
  shape.periodic = {true, true, true};
  auto const spline = sampled<float>(shape, rough);
  auto const grid = spline.view<double, CubicBspline, 3>(0, 0);
  expect_same<CubicBspline>(grid);
  Owned<CubicBspline> const cells(grid);
  for (Vec3d const p : {Vec3d{0.25, 5.5, 4.75}, Vec3d{6.5, 3.125, 0.5}}) {
    Vec3d const on{p.x - 14, p.y + 18, p.z + 5};
    EXPECT_EQ(cells.view.sample(p).refractivity, cells.view.sample(on).refractivity);
    EXPECT_EQ(cells.view.sample(p).gradient, cells.view.sample(on).gradient);
  }
  auto const linear = sampled<float>(shape, rough, false);
  expect_same<Linear>(linear.view<double, Linear, 3>(0, 0));
}

// The second point is in the neighbouring cell. The polynomials of both cells have three derivatives in common at the
// face, so their difference is less than 1e-3 times the cubed distance from it.
TEST(CellPolynomials, SampleTwoPointsSideBySide) {
  auto const volume = sampled<float>(open_grid(8, 7, 6), rough);
  auto const grid = volume.view<double, CubicBspline, 3>(0, 0);
  Owned<CubicBspline> const cells(grid);
  Vec3d const p{2.9999, 3.4, 1.00001}, q{3.0001, 3.4003, 0.9999};
  IndexSample<double> at[2];
  cells.view.sample_pair(p, q, at);
  EXPECT_NEAR(at[0].refractivity, grid.sample(p).refractivity, 7e-17);
  EXPECT_NEAR(at[1].refractivity, grid.sample(q).refractivity, 1e-3 * 1e-12);
  EXPECT_LT(length(at[1].gradient - grid.sample(q).gradient), 1e-3 * 3e-8);
}

// Rays through the box, out of its side between two steps, past it, and from inside it: with samples in pairs, they
// take the same steps as with single samples. The tolerances are the roundings of trace_together_test: 30 steps,
// lengths of 10 m, directions of length 1.
TEST(CellPolynomials, TraceTheSameRays) {
  auto const volume = sampled<float>(open_grid(9, 9, 9), [](Vec3d p) { return 10 * rough(p); });
  auto const grid = volume.view<double, CubicBspline, 3>(0, 0);
  Owned<CubicBspline> const cells(grid);
  Ray<double> const rays[] = {{{3.1, 4.2, -2}, normalized(Vec3d{0.05, -0.02, 1})},
                              {{6.5, 4.0, -2}, normalized(Vec3d{0.45, 0.1, 1})},
                              {{9.0, 4.0, -2}, {0, 0, 1}},
                              {{4.0, 3.0, 2.5}, normalized(Vec3d{-0.1, 0.2, 1})}};
  TracingOptions<double> options;
  options.step = 0.3;
  options.ambient_refractivity = 2e-4;
  for (Faces const faces : {Faces::matched, Faces::refract}) {
    options.faces = faces;
    for (Ray<double> const& ray : rays) {
      Ray<double> const start[1] = {ray};
      MediumPassage<double> a[1], b[1];
      trace_medium(grid, options, start, a);
      trace_medium(cells.view, options, start, b);
      EXPECT_EQ(a[0].status, b[0].status);
      EXPECT_EQ(a[0].crossed, b[0].crossed);
      EXPECT_EQ(a[0].crossed, length(a[0].turn) > 1e-4);
      EXPECT_NEAR(a[0].t, b[0].t, 2e-13);
      EXPECT_NEAR(a[0].optical_path, b[0].optical_path, 2e-13);
      EXPECT_LT(length(a[0].shift - b[0].shift), 2e-13);
      EXPECT_LT(length(a[0].turn - b[0].turn), 2e-14);
    }
  }
}

}  // namespace
}  // namespace gladstone
