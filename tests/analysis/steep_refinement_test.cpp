#include "analysis/correlation/steep_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "analysis/correlation/standard_correlator.h"
#include "render/base/parallel.h"
#include "render/base/units.h"
#include "studies/benchmark/particle_pair.h"

namespace gladstone {
namespace {

/// Grid of windows of 20 px, 8 px apart.
InterrogationGrid grid_of(int columns, int rows) {
  InterrogationGrid grid;
  grid.window_px = 20;
  grid.spacing_px = 8;
  grid.columns = columns;
  grid.rows = rows;
  return grid;
}

GridVector measured_vector_of(Vec2d displacement, double correlation) {
  GridVector vector;
  vector.displacement = vector.raw = displacement;
  vector.correlation = correlation;
  vector.status = VectorStatus::valid;
  vector.reason = VectorReason::measured;
  return vector;
}

template <class Displacement>
std::vector<GridVector> vectors_of(InterrogationGrid const& grid, Displacement const& displacement) {
  std::vector<GridVector> vectors;
  for (std::size_t i = 0; i < grid.size(); ++i)
    vectors.push_back(measured_vector_of(displacement(grid.centre(i)), 0.98));
  return vectors;
}

Vec2d affine(Vec2d p) { return {1.0 + 0.3 * p.x - 0.5 * p.y, -2.0 + 0.1 * p.x + 0.4 * p.y}; }

// A shear of g px/px changes the displacement by 8 g px from one vector to the next.
TEST(SteepRefinement, BeginsAtTheSteepGradient) {
  InterrogationGrid const grid = grid_of(7, 5);
  for (double const part : {0.99, 1.01}) {
    for (int const axis : {0, 1}) {
      std::vector<GridVector> vectors = vectors_of(grid, [&](Vec2d p) {
        return Vec2d{part * steep_gradient * (axis == 0 ? p.x : p.y), 0.0};
      });
      EXPECT_EQ(has_steep_gradient(vectors, grid), part > 1.0) << axis;
      for (GridVector& vector : vectors) vector.status = VectorStatus::masked;
      EXPECT_FALSE(has_steep_gradient(vectors, grid)) << "masked vectors do not count";
    }
  }
}

// A least-squares plane through values of an affine field is that field, also beyond the values. A corner of four
// windows is wrong, and correlates at 0.3; its border at least has two rings of correct nodes around.
TEST(SteepRefinement, ExtrapolatesAffineFieldsExactly) {
  InterrogationGrid const grid = grid_of(12, 10);
  std::vector<GridVector> vectors = vectors_of(grid, affine);
  std::vector<bool> wrong(grid.size());
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) {
      std::size_t const i = static_cast<std::size_t>(row * grid.columns + column);
      vectors[i] = measured_vector_of({10.0 * column, -7.0 * row}, 0.3);
      wrong[i] = true;
    }
  for (double const fraction : min_fractions_of_best_correlation) {
    RefinementPlan const plan = plan_refinement(vectors, grid, fraction);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      EXPECT_EQ(plan.mismatched[i] != 0, wrong[i]) << i;
      EXPECT_LT(length(plan.nodes[i] - affine(grid.centre(i))), 1e-9) << i;
    }
  }
}

// Windows that reach into the steep half are wanted, others keep their vectors. A window of 20 px spans two nodes.
TEST(SteepRefinement, WantsOnlyVectorsBesideSteepGradients) {
  InterrogationGrid const grid = grid_of(20, 6);
  double const kink = grid.centre(GridAxis::x, 10);
  std::vector<GridVector> const vectors = vectors_of(grid, [&](Vec2d p) {
    return Vec2d{0.0, p.x > kink ? 0.5 * (p.x - kink) : 0.0};
  });
  RefinementPlan const plan = plan_refinement(vectors, grid, 0.5);
  for (std::size_t i = 0; i < grid.size(); ++i)
    EXPECT_EQ(plan.wanted[i] != 0, static_cast<int>(i) % grid.columns >= 8) << i;
}

TEST(SteepRefinement, KeepsTheBetterCorrelation) {
  InterrogationGrid const grid = grid_of(4, 4);
  std::size_t const size = grid.size();
  RefinedPass pass{vectors_of(grid, affine), std::vector<WindowCorrelation>(size)}, refined = pass;
  for (std::size_t i = 0; i < size; ++i) {
    refined.vectors[i].displacement += Vec2d{0.5, 0.0};
    refined.windows[i].peaks = 1;
  }
  refined.vectors[1].correlation = 0.9;                // worse
  refined.vectors[2].status = VectorStatus::invalid;   // rejected
  refined.vectors[3].status = VectorStatus::replaced;  // by its neighbours
  pass.vectors[4].status = VectorStatus::invalid;      // was rejected before
  refined.vectors[4].correlation = 0.5;
  RefinementPlan plan{std::vector<Vec2d>(size), std::vector<char>(size, 1), std::vector<char>(size),
                      std::vector<char>(size)};
  plan.wanted[5] = 0;
  EXPECT_EQ(take_refined(pass, refined, plan, {}), 0.5);
  for (std::size_t i = 0; i < size; ++i) {
    bool const kept = i == 1 || i == 2 || i == 3 || i == 5;
    EXPECT_EQ(pass.windows[i].peaks, kept ? 0 : 1) << i;
    EXPECT_EQ(pass.vectors[i].displacement.x, affine(grid.centre(i)).x + (kept ? 0.0 : 0.5)) << i;
  }
}

// The extrapolated displacement of a mismatched vector moves its window out of the frames.
TEST(SteepRefinement, RejectsMismatchedVectorsThatLeadOutOfTheFrames) {
  InterrogationGrid const grid = grid_of(4, 4);
  std::size_t const size = grid.size();
  for (bool const replaces : {true, false}) {
    RefinedPass pass{vectors_of(grid, affine), std::vector<WindowCorrelation>(size)}, refined = pass;
    refined.vectors[6].status = refined.vectors[7].status = VectorStatus::masked;
    RefinementPlan plan{std::vector<Vec2d>(size, Vec2d{30.0, -8.0}), std::vector<char>(size, 1),
                        std::vector<char>(size), std::vector<char>(size)};
    plan.mismatched[6] = 1;
    EXPECT_EQ(take_refined(pass, refined, plan, {.replaces = replaces}), 0.0);
    EXPECT_EQ(pass.vectors[6].status, replaces ? VectorStatus::replaced : VectorStatus::invalid);
    EXPECT_EQ(pass.vectors[6].failed, FailedTest::displacement);
    EXPECT_EQ(pass.vectors[6].displacement.x == 30.0, replaces);
    EXPECT_EQ(pass.vectors[7].status, VectorStatus::valid) << "matched before";
  }
}

ParticlePair pair_of(std::function<Vec2d(Vec2d)> const& displacement, int side = 192) {
  ParticleSettings particles;
  particles.columns = particles.rows = side;
  particles.particles_per_px = 0.05;
  return render_particle_pair(particles, displacement);
}

DisplacementField correlate(ParticlePair const& pair, int steep_passes) {
  CorrelationSettings settings;
  settings.steep_passes = steep_passes;
  return make_standard_correlator(settings)->correlate(pair.reference, pair.flow);
}

double mean_error(DisplacementField const& field, std::function<Vec2d(Vec2d)> const& truth) {
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    if (!field.counts(i)) continue;
    sum += length(field.displacement_px[i] - truth(field.position_px[i]));
    count += 1.0;
  }
  return sum / count;
}

bool are_equal(DisplacementField const& a, DisplacementField const& b) {
  return a.size() == b.size() && a.status == b.status &&
         std::memcmp(a.displacement_px.data(), b.displacement_px.data(), a.size() * sizeof(Vec2d)) == 0;
}

// A shear of 0.4 px/px, with displacements of up to 33 px in the corners, beyond the search range of 32 px of the first
// pass. The deformation of the frames removes an affine field entirely. What remains are sheared particle images: over
// the radius of 1.5 px of a particle, the displacements of its two images differ by 0.6 px from their mean. Averaged
// over the 20 particles of a window and reduced by their random positions in it, this is less than 0.05 px.
TEST(SteepRefinement, RecoversAnAffineField) {
  auto const shear = [](Vec2d p) { return Vec2d{0.4 * (p.y - 79.5), 0.1 * (p.x - 79.5)}; };
  ParticlePair const pair = pair_of(shear, 160);
  EXPECT_GT(mean_error(correlate(pair, 0), shear), 1.0);
  EXPECT_LT(mean_error(correlate(pair, 8), shear), 0.05);
}

// Waves of 32 px and 1 px are damped to 0.64 by the default passes. A window of 20 px has the response H = exp(-pi/2
// (20/32)^2) = 0.54, and the predictor retains a part of at least p = 0.8 of a wave of four nodes, so that each further
// pass changes the response r to H + (1 - H) p r, with the limit H / (1 - (1 - H) p) = 0.85: the error of 0.36 becomes
// 0.15.
TEST(SteepRefinement, ReducesTheDampingOfShortWaves) {
  auto const wave = [](Vec2d p) { return Vec2d{std::sin(p.y * pi / 16.0), std::sin(p.x * pi / 16.0)}; };
  ParticlePair const pair = pair_of(wave);
  EXPECT_LT(mean_error(correlate(pair, 8), wave), 0.5 * mean_error(correlate(pair, 0), wave));
}

TEST(SteepRefinement, DoesNotConcernWeakGradients) {
  auto const vortex = [](Vec2d p) { return Vec2d{0.05 * (p.y - 95.5), -0.05 * (p.x - 95.5)}; };
  ParticlePair const pair = pair_of(vortex);
  EXPECT_TRUE(are_equal(correlate(pair, 0), correlate(pair, 8)));
}

TEST(SteepRefinement, DoesNotDependOnTheNumberOfThreads) {
  auto const wave = [](Vec2d p) { return Vec2d{8.0 * std::sin(p.y / 16.0), 4.0 * std::cos(p.x / 20.0)}; };
  ParticlePair const pair = pair_of(wave);
  int const before = thread_count();
  set_thread_count(1);
  DisplacementField const expected = correlate(pair, 8);
  set_thread_count(3);
  EXPECT_TRUE(are_equal(correlate(pair, 8), expected));
  set_thread_count(before);
}

// A single pass deforms nothing, and the heights of phase correlations do not measure the agreement of the frames.
TEST(SteepRefinement, ConcernsSeveralPassesOfGreyLevels) {
  CorrelationSettings settings;
  EXPECT_EQ(CorrelationSchedule(settings).steep_passes(), settings.steep_passes);
  settings.method = "rpc";
  EXPECT_EQ(CorrelationSchedule(settings).steep_passes(), 0);
  settings.method = "scc";
  settings.window_px = {32};
  EXPECT_EQ(CorrelationSchedule(settings).steep_passes(), 0);
}

}  // namespace
}  // namespace gladstone
