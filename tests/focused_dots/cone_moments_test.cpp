#include "render/focused_dots/cone_moments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "render/base/units.h"
#include "render/focused_dots/deflection_map.h"
#include "render/focused_dots/dot_exposure.h"
#include "render/focused_dots/light_model.h"
#include "tests/focused_dots/picture_error.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

constexpr double stop = 4.77e-3, sent = 6.5e-3, distance = 1.0, way = 0.25;  // Table 1 [m]

/// A table whose rays are displaced by d and bent by b times the pupil point, as seen from the dot on the axis: a lens
/// for a medium.
struct LensTable {
  DeflectionTable table;
  std::vector<KeptVector> displacements, bends;
  std::vector<KeptSlopes> none;

  LensTable(double d, double b) {
    SquareLattice lattice;
    lattice.columns = lattice.rows = 41;
    lattice.spacing = 1e-4;
    lattice.per_metre = 1e4;
    lattice.first = {-20e-4, -20e-4};
    for (int row = 0; row < lattice.rows; ++row) {
      for (int column = 0; column < lattice.columns; ++column) {
        Vec2d const pupil = lattice.node(column, row) / way;
        displacements.push_back(KeptVector::of(d * pupil));
        bends.push_back(KeptVector::of(b * pupil));
      }
    }
    none.resize(displacements.size());
    table.straight = table.sloping = lattice;
    table.way = way;
    table.displacements = displacements.data();
    table.bends = bends.data();
    table.displacement_slopes = table.bend_slopes = none.data();
  }

  /// The dot's cone where rays agree with the table.
  CorrectedCone cone() const {
    TableCheck check;
    check.rays = check.weight = check.pupil2 = 1;
    return {table, stop, sent, distance, {}, check};
  }
};

// Cubic Lagrange polynomials reproduce cubics, between nodes and up to the lattice's edges.
TEST(SquareLattice, ReproducesCubicsUpToItsEdges) {
  SquareLattice lattice;
  lattice.columns = 7;
  lattice.rows = 5;
  lattice.spacing = 0.5;
  lattice.per_metre = 2;
  lattice.first = {-1, 2};
  auto const cubic = [](Vec2d q) { return Vec2d{q.x * q.x * q.x - 2 * q.x * q.y * q.y, q.y * q.y * q.y + q.x}; };
  std::vector<Vec2d> nodes;
  for (int row = 0; row < lattice.rows; ++row) {
    for (int column = 0; column < lattice.columns; ++column) nodes.push_back(cubic(lattice.node(column, row)));
  }
  for (Vec2d const q : {Vec2d{-1, 2}, Vec2d{2, 4}, Vec2d{-0.99, 3.97}, Vec2d{0.3, 2.9}, Vec2d{1.9, 2.1}}) {
    ASSERT_TRUE(lattice.covers(q, 0));
    Vec2d const off = interpolate<Vec2d>(lattice.about(q), nodes.data()) - cubic(q);
    EXPECT_LT(length(off), 1e-12) << q.x << " " << q.y;
  }
  EXPECT_FALSE(lattice.covers({2.01, 3}, 0));
  EXPECT_FALSE(lattice.covers({0, 3}, 1.01));
}

// Rays to a pupil point P arrive at (1 + b) P: those that pass the stop were sent within R / (1 + b), whether the look
// for the edge is a short one (b = 0.002) or a long one (0.3); what is linear both find to rounding. A medium that
// bends more than it spreads light, b < -1, turns the pupil over: no simple edge.
TEST(CorrectedCone, FindsTheRimThatTheMediumMovedInOrOut) {
  for (double const b : {0.0, 0.002, -0.004, 0.3, -0.2}) {
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
// light that arrives (r/R)^2 of what left, r = R/(1 + b). Both rules: to 1e-9 with a rim, to 1e-3 where the stop's edge
// is smoothed.
TEST(ConeRule, IntegratesALensInClosedForm) {
  double const d = 20.0, b = 0.02;
  auto const setup = table1_setup(64);
  Scene scene = scene_with_dots(setup, {{31.5, 31.5}}, 64);
  scene.medium.finest = 1e-4;
  LensTable const lens(d, b);
  OwnedLightModel const light(on_bench(scene), scene.dots, nullptr, lens.table);
  CorrectedCone const cone = lens.cone();
  ConeRule const& rule = light.model.cone;
  std::vector<double> rims;
  for (int k = 0; k < rule.direction_count; ++k) rims.push_back(cone.rim({}, rule.directions[k]));
  DisplacementMoments exact, smooth;
  double all_exact = 0, all_smooth = 0;
  for (int k = 0; k < rule.count; ++k) {
    ConeLight const part = cone_light(cone, rule, k, {}, rims.data());
    exact.add(part.weight, part.displacement);
    all_exact += part.without_medium;
  }
  for (int k = 0; k < rule.scattered_count; ++k) {
    ConeLight const part = smoothed_light(cone, rule, k, {});
    smooth.add(part.weight, part.displacement);
    all_smooth += part.without_medium;
  }
  using M = DisplacementMoments;
  double const r = stop / (1 + b);
  cone.finish(exact, all_exact);
  cone.finish(smooth, all_smooth);
  for (auto [moments, tolerance] : {std::pair{&exact, 1e-9}, std::pair{&smooth, 2e-3}}) {
    double const light_here = moments->of[0], x2 = moments->of[M::at(2, 0)], x4 = moments->of[M::at(4, 0)];
    // cos^4 falls by 2 (P/Z)^2 towards the rim: 2.3e-5 of it all, which the mean takes out
    EXPECT_NEAR(light_here, r * r / (stop * stop), 1e-6 + tolerance);
    EXPECT_NEAR(x2 / light_here / (d * d * r * r / 4), 1, 2e-5 + tolerance);
    EXPECT_NEAR(moments->of[M::at(0, 2)] / x2, 1, 1e-6 + tolerance);
    EXPECT_NEAR(x4 / light_here / (std::pow(d * r, 4) / 8), 1, 5e-5 + 3 * tolerance);
    EXPECT_NEAR(moments->of[M::at(1, 1)] / x2, 0, tolerance);
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

/// One dot's truth and its light in the flow, with a table or by its rays alone.
struct SeenDot {
  Vec2d displacement;
  std::vector<double> light;
};
SeenDot see(Scene const& scene, std::size_t dot, DeflectionTable const& table) {
  std::optional<AiryTable> airy;
  SpotView const spot = make_spot(scene, airy);
  OwnedLightModel const model(on_bench(scene), scene.dots, &spot, table);
  LightImage frames[2] = {{scene.setup.camera.columns, scene.setup.camera.rows},
                          {scene.setup.camera.columns, scene.setup.camera.rows}};
  LightImage* const images[2] = {&frames[0], &frames[1]};
  DotExposure exposure(model.model, true);
  GroundTruth truth;
  truth.resize(1);
  std::visit(
      [&](auto const& medium) {
        TracePair<double, std::decay_t<decltype(medium)>> const pair{on_bench(scene).view(), medium};
        exposure.begin(scene.dots.centre[dot], 1.0, images, on_bench(scene).light_per_ray(scene.dots));
        trace_dot(pair, dot, scene.rays_per_dot, exposure);
        exposure.finish(truth, 0);
      },
      scene.medium.view);
  Image<double> const light = frames[1].to_light();
  return {truth.displacement_px[0], {light.begin(), light.end()}};
}

double const of_four = std::pow(4, 0.25), of_eight = std::pow(8, 0.25);

struct Case {
  char const* instant;
  std::uint64_t rays;
  double truth_px, of_peak;
};
class TableAgainstRays : public testing::TestWithParam<Case> {};

// Few rays with a table give what very many give without, in truth and in light: on the decayed plane 32 rays come to
// 5e-4 px and a grey level of 12 bits, on the early one, whose fronts spread a dot's rays over several pixels, 128
// rays to 3e-3 px and 1 % of the peak, and 1024, of which the fronts turn many away from the stop, to half of that
// (by themselves they are off by 5e-3 px and 2 %). The 32768 rays alone are good to some 2e-4 px and 1e-4 of the peak
// on the first, ten times as much on the other; 32 alone are off by 0.01 px and 3 %. These numbers are of rays that
// follow one sequence. Dealt to g independent ones, whose scatter tells truth's error, they leave g^(1/4) of it: errors
// of edges in two dimensions fall as N^(-3/4), so (N/g)^(-3/4) / sqrt(g) stands in the place of N^(-3/4).
TEST_P(TableAgainstRays, AgreeOnTruthAndLight) {
  Case const& c = GetParam();
  auto setup = table1_setup(256);
  setup.medium.field = dns_plane(c.instant);
  Scene few = scene_with_dots(setup, lattice(256, 60, 4), c.rays);
  few.pupil_margin *= 1.5;
  DeflectionMap const map(on_bench(few), DeflectionPlan(on_bench(few), few.dots));
  ASSERT_TRUE(map.table().exists());
  Scene many = few;
  many.rays_per_dot = 32768;
  double square = 0, light = 0;
  int lit = 0;
  std::vector<std::size_t> const dots{60 * 12 + 15, 60 * 30 + 41, 60 * 44 + 22, 60 * 21 + 35};
  for (std::size_t const dot : dots) {
    SeenDot const table = see(few, dot, map.table()), rays = see(many, dot, {});
    Vec2d const off = table.displacement - rays.displacement;
    square += (off.x * off.x + off.y * off.y) / 2;
    double const peak = *std::max_element(rays.light.begin(), rays.light.end());
    for (std::size_t i = 0; i < rays.light.size(); ++i) {
      if (rays.light[i] < peak / 4096) continue;
      light += std::pow((table.light[i] - rays.light[i]) / peak, 2);
      ++lit;
    }
  }
  EXPECT_LT(std::sqrt(square / double(dots.size())), c.truth_px);
  EXPECT_LT(std::sqrt(light / lit), c.of_peak);
}
INSTANTIATE_TEST_SUITE_P(DnsPlane, TableAgainstRays,
                         testing::Values(Case{"late", 32, 5e-4 * of_eight, of_eight / 4096},
                                         Case{"kepeak", 128, 3e-3 * of_eight, 0.01 * of_eight},
                                         Case{"kepeak", 1024, 1.5e-3 * of_four, 0.005 * of_four}),
                         [](auto const& instance) {
                           return std::string(instance.param.instant) + std::to_string(instance.param.rays);
                         });

struct FineSpot {
  double f_number, dot_px;
};
class TableUnderFineSpots : public testing::TestWithParam<FineSpot> {};

// Spots much finer than a pixel show what the series leaves: on the decayed plane a table with 256 rays gives the
// images of four dots, rms over lit pixels, to 1.5 grey levels of 12 bits of what 65,536 rays each give alone, which
// scatter by as much; by 4^(1/4) of that since they are dealt to four sequences.
TEST_P(TableUnderFineSpots, GivesTheirLight) {
  auto setup = table1_setup(96);
  setup.medium.field = dns_plane("late");
  setup.lens.f_number = GetParam().f_number;
  setup.target.dot_diameter_px = GetParam().dot_px;
  std::vector<Vec2d> const few{{17.3, 17.8}, {77.6, 17.1}, {17.9, 77.4}, {77.2, 77.5}};
  std::vector<Vec2d> all = few;  // the others make a table pay and lie apart from the four
  for (double y = 1.7; y < 95; y += 4.3) {
    for (double x = 2.1; x < 95; x += 4.3) {
      auto const near = [&](Vec2d p) { return std::abs(p.x - x) < 8 && std::abs(p.y - y) < 8; };
      if (std::none_of(few.begin(), few.end(), near)) all.push_back({x, y});
    }
  }
  Scene by_rays = scene_with_dots(setup, few, 65536), by_table = scene_with_dots(setup, all, 256);
  ASSERT_FALSE(DeflectionPlan(on_bench(by_rays), by_rays.dots).wanted());
  ASSERT_TRUE(DeflectionPlan(on_bench(by_table), by_table.dots).wanted());
  Image<double> const exact = render_all(by_rays).light.flow, found = render_all(by_table).light.flow;
  EXPECT_LT(picture_error(found, exact).rms_levels, 1.5 * of_four);
}
INSTANTIATE_TEST_SUITE_P(DnsPlane, TableUnderFineSpots,
                         testing::Values(FineSpot{8, 0}, FineSpot{8, 3}, FineSpot{5.6, 0}, FineSpot{5.6, 3}));

}  // namespace
}  // namespace gladstone
