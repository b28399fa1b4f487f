#include "render/focused_dots/dot_cone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "render/base/units.h"
#include "render/focused_dots/owned_dot_model.h"
#include "tests/focused_dots/picture_error.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

constexpr double stop = 4.77e-3, distance = 1.0, way = 0.25;  // Table 1 [m]

/// A table whose rays are displaced by d and bent by b times the pupil point, as seen from the dot on the axis: a lens
/// for a medium.
struct LensTable {
  DeflectionTable table;
  std::vector<TableVector> displacements, shifts;
  std::vector<TableSlopes> none;

  LensTable(double d, double b) {
    SquareLattice lattice;
    lattice.columns = lattice.rows = 41;
    lattice.spacing = 1e-4;
    lattice.per_metre = 1e4;
    lattice.first = {-20, -20};
    for (int row = 0; row < lattice.rows; ++row) {
      for (int column = 0; column < lattice.columns; ++column) {
        Vec2d const pupil = lattice.node(column, row) / way;
        displacements.push_back(TableVector::of(d * pupil));
        shifts.push_back(TableVector::of(b * pupil));
      }
    }
    none.resize(displacements.size());
    table.straight = table.sloping = lattice;
    table.way = way;
    table.displacements = displacements.data();
    table.shifts = shifts.data();
    table.displacement_slopes = table.shift_slopes = none.data();
  }

  /// The dot's cone where rays agree with the table.
  CorrectedCone cone() const {
    TableCheck check;
    check.rays = check.square = 1;
    return {table, stop, distance, {}, {}, check};
  }
};

// Cubic Lagrange polynomials reproduce cubics up to the lattice's edges, and a node within with the same bits wherever
// it begins.
TEST(SquareLattice, ReproducesCubicsWhereverItBegins) {
  auto const cubic = [](Vec2d q) { return Vec2d{q.x * q.x * q.x - 2 * q.x * q.y * q.y, q.y * q.y * q.y + q.x}; };
  auto const lattice_from = [](int column, int row, int columns, int rows) {
    SquareLattice lattice;
    lattice.columns = columns;
    lattice.rows = rows;
    lattice.spacing = 0.3;
    lattice.per_metre = 1 / 0.3;
    lattice.first = {column, row};
    return lattice;
  };
  auto const value = [&](SquareLattice const& lattice, Vec2d q) {
    std::vector<Vec2d> nodes;
    for (int row = 0; row < lattice.rows; ++row) {
      for (int column = 0; column < lattice.columns; ++column) nodes.push_back(cubic(lattice.node(column, row)));
    }
    return interpolate<Vec2d>(lattice.about(q), nodes.data());
  };
  SquareLattice const small = lattice_from(-3, 6, 9, 7), large = lattice_from(-1000, -200, 1010, 230);
  for (Vec2d const q : {Vec2d{-0.59, 2.11}, Vec2d{1.19, 3.29}, Vec2d{-0.31, 2.97}, Vec2d{0.3, 2.9}}) {
    ASSERT_TRUE(small.covers(q, 0));
    EXPECT_LT(length(value(small, q) - cubic(q)), 1e-12) << q.x << " " << q.y;
    // the compiler may fuse other products where it inlines the same sum a second time
    EXPECT_DOUBLE_EQ(value(small, q).x, value(large, q).x) << q.x << " " << q.y;
    EXPECT_DOUBLE_EQ(value(small, q).y, value(large, q).y) << q.x << " " << q.y;
  }
  // at the edges, of x from -0.9 to 1.5 and y from 1.8 to 3.6, within the rounding of numbers of some tens as above
  for (Vec2d const q : {Vec2d{-0.9, 3.6}, Vec2d{-0.9, 1.8}, Vec2d{1.5, 3.6}, Vec2d{-0.89, 3.58}, Vec2d{1.45, 1.85}}) {
    EXPECT_LT(length(value(small, q) - cubic(q)), 1e-12) << q.x << " " << q.y;
  }
  EXPECT_FALSE(small.covers({1.51, 3}, 0));
  EXPECT_FALSE(small.covers({0, 3}, 1.21));
  EXPECT_FALSE(small.covers({std::nan(""), 3}, 0));
}

// Rays to a pupil point P arrive at (1 + b) P: those that pass the stop were sent within R / (1 + b), whether the look
// for the edge is a short one (b = 0.002) or a long one (0.3); what is linear both find to rounding. A medium that
// bends more than it spreads light, b < -1, turns the pupil over: no simple edge. Rays further out than 1.25 R
// (CorrectedCone::reach) are not looked at, which b = -0.2 would send there: -0.15 sends them to 1.18 R.
TEST(CorrectedCone, FindsTheRimThatTheMediumMovedInOrOut) {
  for (double const b : {0.0, 0.002, -0.004, 0.3, -0.15}) {
    LensTable const lens(0, b);
    CorrectedCone const cone = lens.cone();
    for (double const angle : {0.0, 0.7, 3.0}) {
      EXPECT_NEAR(cone.rim({}, {std::cos(angle), std::sin(angle)}) / stop, 1 / (1 + b), 1e-11) << b;
    }
  }
  LensTable const folded(0, -1.5);
  EXPECT_TRUE(std::isnan(folded.cone().rim({}, {1, 0})));
}

// Uniform displacement d P over a disc of radius r: variance along x is d^2 r^2 / 4, the fourth moment d^4 r^4 / 8, the
// light that arrives (r/R)^2 of what left, r = R/(1 + b). Both rules. With a rim to 1e-9 beside what cos^4 makes. Where
// the stop's edge is smoothed, the smoothing itself leaves nothing of light, second and fourth moments, integrals of 1,
// u and u^2 over u = (r/R)^2, since three moments of its kernel vanish (ApertureStop); the N points, 1024 and more,
// leave N^(-3/4) = 5.5e-3 of a sharp edge's and less than half of that, 2e-3, of a smooth one's: three times as much of
// u^2, whose integral u^3/3 changes with the rim three times as fast as the light does.
TEST(ConeRule, IntegratesALensInClosedForm) {
  double const d = 20.0, b = 0.02;
  auto const setup = table1_setup(64);
  Scene scene = scene_with_dots(setup, {{31.5, 31.5}}, 64);
  scene.medium.finest = 1e-4;
  LensTable const lens(d, b);
  OwnedDotModel const owned(focused_dots(scene).value(), scene.dots, lens.table, false);
  CorrectedCone const cone = lens.cone();
  ConeRule const& rule = owned.model.cone;
  std::vector<double> rims;
  for (int k = 0; k < rule.direction_count; ++k) rims.push_back(cone.rim({}, rule.directions[k]));
  using M = DisplacementMoments;
  double const r = stop / (1 + b);
  using Edge = std::pair<double const*, double>;
  for (auto const& [edge, tolerance] : {Edge{rims.data(), 1e-9}, Edge{nullptr, 2e-3}}) {
    DisplacementMoments moments;
    double all = 0;
    for (int k = 0; k < rule.points_of(edge != nullptr); ++k) {
      ConeLight const part = cone_light(cone, rule, k, {}, edge);
      moments.add(part.weight, part.displacement);
      all += part.without_medium;
    }
    cone.finish(moments, all);
    double const light_here = moments.of[0], x2 = moments.of[M::at(2, 0)], x4 = moments.of[M::at(4, 0)];
    // cos^4 falls by 2 (P/Z)^2 towards the rim: 2.3e-5 of it all, which the mean takes out
    EXPECT_NEAR(light_here, r * r / (stop * stop), 1e-6 + tolerance);
    EXPECT_NEAR(x2 / light_here / (d * d * r * r / 4), 1, 2e-5 + tolerance);
    EXPECT_NEAR(moments.of[M::at(0, 2)] / x2, 1, 1e-6 + tolerance);
    EXPECT_NEAR(x4 / light_here / (std::pow(d * r, 4) / 8), 1, 5e-5 + 3 * tolerance);
    EXPECT_NEAR(moments.of[M::at(1, 1)] / x2, 0, tolerance);
  }
}

// A spot moved by m is its Taylor series: what is left after the fourth order is the fifth, m^5/5! times at most 5.8
// sigma^-5 of the peak (the Hermite polynomial He_5 under the bell).
TEST(GaussianSpot, MovesByItsTaylorSeries) {
  GaussianSpot<double> const spot{0.6};
  int const width = 2 * spot.half_width() + 1;
  double here[5][GaussianSpot<double>::most_width], there[GaussianSpot<double>::most_width];
  double flat[5 * GaussianSpot<double>::most_width];
  double const p = 7.3;
  Footprint const reach = spot.footprint({p, p});
  spot.taylor_shares(p, reach.column, width, 4, flat);
  for (int k = 0; k < 5; ++k) {
    for (int i = 0; i < width; ++i) here[k][i] = flat[k * width + i];
  }
  for (double const moved : {0.05, -0.1, 0.2}) {
    spot.shares(p + moved, reach.column, width, there);
    for (int i = 0; i < width; ++i) {
      double series = 0, power = 1;
      for (int k = 0; k < 5; ++k, power *= moved) series += here[k][i] * power;
      double const bound = std::pow(std::abs(moved) / 0.6, 5) / 120 * 5.8 * 0.4 / 0.6 + 1e-9;
      EXPECT_NEAR(series, there[i], bound) << moved << " " << i;
    }
  }
}

struct FineSpot {
  char const* instant;
  double f_number, dot_px, levels;
};
class TableAgainstRays : public testing::TestWithParam<FineSpot> {};

// Few rays with a table give what very many give by themselves, in truth and in light: four dots each by 256 rays and
// by 65,536 of the general renderer, which know truth to some 1e-4 px and images to half a level of 12 bits, rms over
// lit pixels; spots much finer than a pixel show what the series leaves. Truth is within three of both stated errors.
TEST_P(TableAgainstRays, AgreesOnTruthAndLight) {
  auto const [instant, f_number, dot_px, levels] = GetParam();
  auto setup = table1_setup(96);
  setup.medium.field = dns_plane(instant);
  setup.lens.f_number = f_number;
  setup.target.dot_diameter_px = dot_px;
  Scene scene = scene_with_dots(setup, {{17.3, 17.8}, {77.6, 17.1}, {17.9, 77.4}, {77.2, 77.5}}, 256), many = scene;
  many.rays_per_dot = 65536;
  Rendering const exact = RaysRenderer().render(many, many.dots, RenderImages::yes, RenderTheory::no);
  Rendering const found = FocusedDotsRenderer().render(scene, scene.dots, RenderImages::yes, RenderTheory::no);
  ASSERT_TRUE(found.left.empty());
  for (std::size_t dot = 0; dot < found.truth.size(); ++dot) {
    Vec2d const off = found.truth.displacement_px[dot] - exact.truth.displacement_px[dot];
    Vec2d const one = found.truth.displacement_error_px[dot], other = exact.truth.displacement_error_px[dot];
    EXPECT_LE(std::abs(off.x), 3 * std::hypot(one.x, other.x) + 2e-5) << dot;
    EXPECT_LE(std::abs(off.y), 3 * std::hypot(one.y, other.y) + 2e-5) << dot;
  }
  EXPECT_LT(picture_error(found.light.flow, exact.light.flow).rms_levels, levels);
}
INSTANTIATE_TEST_SUITE_P(DnsPlane, TableAgainstRays,
                         testing::Values(FineSpot{"late", 11, 3, 1.0}, FineSpot{"late", 11, 0, 1.5},
                                         FineSpot{"late", 8, 0, 1.5}, FineSpot{"late", 8, 3, 1.5},
                                         FineSpot{"kepeak", 11, 3, 10}));

}  // namespace
}  // namespace gladstone
