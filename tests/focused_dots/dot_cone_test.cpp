#include "render/focused_dots/dot_cone.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "render/focused_dots/owned_dot_model.h"
#include "tests/focused_dots/picture_error.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

constexpr double stop = 4.77e-3, distance = 1.0, way = 0.25;  // Table 1 [m]

/// Table whose rays have the displacement d and the deflection b times the pupil point, relative to the dot on the
/// axis: the medium is a lens.
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
    table.mid_plane_fraction = way;
    table.displacements = displacements.data();
    table.shifts = shifts.data();
    table.displacement_slopes = table.shift_slopes = none.data();
  }

  /// Returns the light cone of the dot if the traced rays agree with the table.
  CorrectedCone cone() const {
    TableCheck check;
    check.rays = check.square = 1;
    return {table, stop, distance, {}, {}, check};
  }
};

// Cubic Lagrange polynomials reproduce cubics up to the edges of the lattice. Values in the interior are bitwise
// independent of the extent of the lattice.
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
    // if the compiler inlines the same sum a second time, it may fuse other products
    EXPECT_DOUBLE_EQ(value(small, q).x, value(large, q).x) << q.x << " " << q.y;
    EXPECT_DOUBLE_EQ(value(small, q).y, value(large, q).y) << q.x << " " << q.y;
  }
  // at the edges, for x from -0.9 to 1.5 and y from 1.8 to 3.6, within the rounding of numbers of some tens as above
  for (Vec2d const q : {Vec2d{-0.9, 3.6}, Vec2d{-0.9, 1.8}, Vec2d{1.5, 3.6}, Vec2d{-0.89, 3.58}, Vec2d{1.45, 1.85}}) {
    EXPECT_LT(length(value(small, q) - cubic(q)), 1e-12) << q.x << " " << q.y;
  }
  EXPECT_FALSE(small.covers({1.51, 3}, 0));
  EXPECT_FALSE(small.covers({0, 3}, 1.21));
  EXPECT_FALSE(small.covers({std::nan(""), 3}, 0));
}

// Rays to a pupil point P arrive at (1 + b) P: those that pass the stop were sent to points within R / (1 + b). Both
// the short search for the edge (b = 0.002) and the long one (0.3) find this up to rounding, since the problem is
// linear. A medium with b < -1 inverts the pupil, so that there is no simple edge. Rays farther out than 1.25 R
// (CorrectedCone::reach) are not searched: b = -0.2 would need them, b = -0.15 needs rays up to 1.18 R.
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

// A displacement d P, uniform over a disc of radius r: the variance along x is d^2 r^2 / 4, the fourth moment d^4 r^4 /
// 8, and the fraction (r/R)^2 of the light arrives, r = R/(1 + b). This is tested with both rules. With a simple edge,
// the accuracy is 1e-9, apart from cos^4. With a smoothed edge, smoothing does not change light, second and fourth
// moments, which are integrals of 1, u and u^2 over u = (r/R)^2, since three moments of its kernel vanish
// (ApertureStop). The N points, at least 1024, have an error of N^(-3/4) = 5.5e-3 with a sharp edge and less than half
// of that, 2e-3, with a smoothed one; for u^2 it is three times as large, since the integral u^3/3 changes three times
// as fast with the edge as the light does.
TEST(ConeRule, IntegratesALensInClosedForm) {
  double const d = 20.0, b = 0.02;
  auto const setup = table1_setup(64);
  PlannedScene scene = scene_with_dots(setup, {{31.5, 31.5}}, 64);
  scene.medium.finest = 1e-4;
  LensTable const lens(d, b);
  OwnedDotModel const owned(build_focused_dots(scene, scene.plan).value(), scene.dots, lens.table, false);
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
    // Towards the edge, cos^4 decreases by 2 (P/Z)^2, 2.3e-5; its mean over the cone is included in the light.
    EXPECT_NEAR(light_here, r * r / (stop * stop), 1e-6 + tolerance);
    EXPECT_NEAR(x2 / light_here / (d * d * r * r / 4), 1, 2e-5 + tolerance);
    EXPECT_NEAR(moments.of[M::at(0, 2)] / x2, 1, 1e-6 + tolerance);
    EXPECT_NEAR(x4 / light_here / (std::pow(d * r, 4) / 8), 1, 5e-5 + 3 * tolerance);
    EXPECT_NEAR(moments.of[M::at(1, 1)] / x2, 0, tolerance);
  }
}

// A PSF displaced by m is represented by its Taylor series: after the fourth order, the remainder is the fifth, at most
// m^5/5! times 5.8 sigma^-5 of the peak (maximum of the Hermite polynomial He_5 times the Gaussian).
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

// Few rays with a table have the same truth and light as very many rays alone: four dots by 256 rays, and by 65,536
// rays of the general renderer, whose errors are about 1e-4 px in the truth and half a level of 12 bits, rms over lit
// pixels, in images. PSFs much narrower than a pixel reveal the truncation of the series. The truths agree within three
// times the stated errors of both.
TEST_P(TableAgainstRays, AgreesOnTruthAndLight) {
  auto const [instant, f_number, dot_px, levels] = GetParam();
  auto setup = table1_setup(96);
  setup.medium.field = dns_plane(instant);
  setup.lens.f_number = f_number;
  setup.target.dot_diameter_px = dot_px;
  PlannedScene scene = scene_with_dots(setup, {{17.3, 17.8}, {77.6, 17.1}, {17.9, 77.4}, {77.2, 77.5}}, 256),
               many = scene;
  many.plan.rays = 65536;
  Rendering const exact = RaysRenderer().render(many, many.plan, many.dots, RenderImages::yes, RenderTheory::no);
  Rendering const found =
      FocusedDotsRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no);
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
