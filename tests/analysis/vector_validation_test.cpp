#include "analysis/correlation/vector_validation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace gladstone {
namespace {

/// A smooth vortex-like field with small irregularities, all valid.
std::vector<GridVector> smooth_grid(int columns, int rows) {
  std::vector<GridVector> grid;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      GridVector vector;
      vector.displacement = {2.0 + 0.1 * j + 0.02 * std::sin(5.0 * i + j), -1.0 - 0.1 * i + 0.02 * std::cos(3.0 * j)};
      vector.status = VectorStatus::valid;
      grid.push_back(vector);
    }
  return grid;
}

// All neighbours are 0, epsilon 0.1: the normalised residual of the vector (0.3, 0.4) is 0.5/0.1 = 5.
TEST(NormalisedMedian, IsTheDistanceOverTheNoiseLevel) {
  Neighbours<double> neighbours;
  neighbours.count = 8;
  EXPECT_NEAR(normalised_median_residual(Vec2d{0.3, 0.4}, neighbours, 0.1), 5.0, 1e-14);
}

TEST(NormalisedMedian, FlagsAPlantedOutlierAndOnlyThat) {
  for (std::size_t const planted : {std::size_t{0}, std::size_t{5}, std::size_t{34}, std::size_t{59}}) {
    std::vector<GridVector> grid = smooth_grid(10, 6);
    Vec2d const truth = grid[planted].displacement;
    grid[planted].displacement += Vec2d{3.0, -2.0};
    validate_vectors(grid, 10, {});
    for (std::size_t i = 0; i < grid.size(); ++i)
      EXPECT_EQ(grid[i].status, i == planted ? VectorStatus::replaced : VectorStatus::valid) << i << " of " << planted;
    // the median of neighbours one grid step away: the error is at most the change over one step on both axes and the
    // irregularity
    EXPECT_NEAR(grid[planted].displacement.x, truth.x, 0.14);
    EXPECT_NEAR(grid[planted].displacement.y, truth.y, 0.14);
  }
}

TEST(NormalisedMedian, PrefersTheNextPeakThatAgrees) {
  std::vector<GridVector> grid = smooth_grid(10, 6);
  Vec2d const truth = grid[33].displacement;
  grid[33].displacement = {9.0, 9.0};
  grid[33].alternatives = {Vec2d{-9.0, 9.0}, truth};
  grid[33].alternative_count = 2;
  validate_vectors(grid, 10, {});
  EXPECT_EQ(grid[33].status, VectorStatus::replaced);
  EXPECT_EQ(grid[33].displacement, truth);
}

// At the edge of a steep plane the median of the neighbours is one-sided, which is not an error.
TEST(NormalisedMedian, AcceptsTheRimOfASteepPlane) {
  std::vector<GridVector> grid = smooth_grid(10, 6);
  for (std::size_t i = 0; i < grid.size(); ++i)
    grid[i].displacement = {1.5 * static_cast<double>(i / 10), -0.8 * static_cast<double>(i % 10)};
  validate_vectors(grid, 10, {});
  for (GridVector const& vector : grid) EXPECT_EQ(vector.status, VectorStatus::valid);
}

// The predictor of the first column is wrong by 2 px, like one that is extrapolated beyond a crest.
TEST(NormalisedMedian, AcceptsARightVectorWhosePredictorIsWrongAtTheRim) {
  std::vector<GridVector> grid = smooth_grid(10, 6);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid[i].predictor = grid[i].displacement;
    if (i % 10 == 0) grid[i].predictor += Vec2d{i % 20 == 0 ? 2.0 : -1.0, 0.0};
  }
  validate_vectors(grid, 10, {});
  for (GridVector const& vector : grid) EXPECT_EQ(vector.status, VectorStatus::valid);
}

// ... and the replacement of a wrong vector there does not depend on that predictor.
TEST(NormalisedMedian, ReplacesAtTheRimByThePlaneOfTheNeighbours) {
  for (std::size_t const planted : {std::size_t{0}, std::size_t{20}, std::size_t{29}, std::size_t{33}}) {
    std::vector<GridVector> grid = smooth_grid(10, 6);
    Vec2d const truth = grid[planted].displacement;
    for (GridVector& vector : grid) vector.predictor = vector.displacement;
    bool const at_rim = planted != 33;
    if (at_rim) grid[planted].predictor += Vec2d{2.0, 1.0};
    grid[planted].displacement += Vec2d{3.0, -2.0};
    validate_vectors(grid, 10, {});
    EXPECT_EQ(grid[planted].status, VectorStatus::replaced);
    // the irregularity, 0.02 px, extrapolated by one step: at most 1 + 1 + 1 times that at a corner
    EXPECT_NEAR(grid[planted].displacement.x, truth.x, at_rim ? 0.08 : 1e-12) << planted;
    EXPECT_NEAR(grid[planted].displacement.y, truth.y, at_rim ? 0.08 : 1e-12) << planted;
  }
}

TEST(NormalisedMedian, LetsTheLimitBindReplacements) {
  std::vector<GridVector> grid = smooth_grid(10, 6);
  grid[33].displacement = {9.0, 9.0};
  ValidationRule rule;
  rule.limit_px = 1.2;  // below the neighbours' median along y, -1.3
  validate_vectors(grid, 10, rule);
  EXPECT_EQ(grid[33].status, VectorStatus::invalid);
  EXPECT_EQ(grid[33].reason, VectorReason::beyond_limit);
}

// Crest of a wave of four grid steps: the median of its neighbours is 0.
TEST(NormalisedMedian, RetainsCrestSupportedByCorrelation) {
  auto const status_of = [](double height, double peak_ratio, Ambiguity ambiguous, double reliable_peak_ratio) {
    std::vector<GridVector> grid = smooth_grid(5, 5);
    for (GridVector& vector : grid) vector.displacement = {};
    grid[12].displacement = {height, 0.0};
    grid[12].peak_ratio = peak_ratio;
    grid[12].ambiguous = ambiguous;
    ValidationRule rule;
    rule.reliable_peak_ratio = reliable_peak_ratio;
    validate_vectors(grid, 5, rule);
    return grid[12].status;
  };
  EXPECT_EQ(status_of(1.0, 2.1, Ambiguity::none, 2.0), VectorStatus::valid);
  EXPECT_EQ(status_of(1.0, 1.9, Ambiguity::none, 2.0), VectorStatus::replaced) << "uncorrelated images have such peaks";
  EXPECT_EQ(status_of(2.1, 9.0, Ambiguity::none, 2.0), VectorStatus::replaced)
      << "as caused by a speck of dust on the window";
  EXPECT_EQ(status_of(1.0, 9.0, Ambiguity::earlier, 2.0), VectorStatus::replaced) << "an alias";
  EXPECT_EQ(status_of(1.0, 2.1, Ambiguity::none, 3.0), VectorStatus::replaced);
  EXPECT_EQ(status_of(1.0, 1000.0, Ambiguity::none, std::numeric_limits<double>::infinity()), VectorStatus::replaced);
}

TEST(NormalisedMedian, SaysWhereAReplacementIsFrom) {
  std::vector<GridVector> grid = smooth_grid(10, 6);
  for (GridVector& vector : grid) {
    vector.reason = VectorReason::measured;
    vector.raw = vector.displacement;
  }
  Vec2d const truth = grid[33].displacement;
  for (std::size_t const i : {33, 36}) grid[i].displacement = grid[i].raw = {9.0, 9.0};
  grid[33].alternatives[0] = truth;
  grid[33].alternative_count = 1;
  validate_vectors(grid, 10, {});
  EXPECT_EQ(grid[33].reason, VectorReason::other_peak);
  EXPECT_EQ(grid[36].reason, VectorReason::neighbours);
  EXPECT_EQ(grid[34].reason, VectorReason::measured);
  for (std::size_t i = 0; i < grid.size(); ++i)
    EXPECT_EQ(grid[i].failed, i == 33 || i == 36 ? FailedTest::median : FailedTest::none) << i;
  for (std::size_t const i : {33, 36}) EXPECT_EQ(grid[i].raw, (Vec2d{9.0, 9.0})) << "as measured";
}

// Each vector fails the test for which it was constructed.
TEST(ValidateVectors, SayWhichTestAVectorFailed) {
  for (bool const replace : {true, false}) {
    std::vector<GridVector> grid = smooth_grid(10, 8);
    for (GridVector& vector : grid) {
      vector.raw = vector.displacement;
      vector.predictor = vector.displacement;
      vector.correlation = 0.8;
      vector.peak_ratio = 4.0;
    }
    std::map<std::size_t, FailedTest> const planted{{11, FailedTest::median},
                                                    {17, FailedTest::displacement},
                                                    {44, FailedTest::peak_ratio},
                                                    {62, FailedTest::correlation}};
    grid[11].displacement += Vec2d{3.0, 0.0};
    grid[17].displacement += Vec2d{3.0, 0.0};
    grid[17].predictor = grid[17].displacement;
    grid[17].correlation = 0.5;
    grid[44].peak_ratio = 1.1;
    grid[62].correlation = 0.2;
    ValidationRule rule;
    rule.displacement_threshold = 2.0;
    rule.reliable_peak_ratio = std::numeric_limits<double>::infinity();
    rule.least_peak_ratio = 1.2;
    rule.least_correlation = 0.3;
    rule.replaces = replace;
    validate_vectors(grid, 10, rule);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      auto const found = planted.find(i);
      bool const failed = found != planted.end();
      EXPECT_EQ(grid[i].failed, failed ? found->second : FailedTest::none) << i;
      EXPECT_EQ(grid[i].status, !failed   ? VectorStatus::valid
                                : replace ? VectorStatus::replaced
                                          : VectorStatus::invalid)
          << i;
      if (failed) {
        EXPECT_EQ(grid[i].reason, replace ? VectorReason::neighbours : VectorReason::not_replaced) << i;
      }
    }
  }
}

// An error of an earlier pass is in the predictor, and the last pass adds nothing to it: it is detected because the
// neighbours correlate better, but not if the test is off, if the window correlates as well as its neighbours, or if
// the field is steep. In the corner the vector is replaced by the plane through three neighbours, which have
// irregularities of 0.02 px: the plane's value there, the sum of two neighbours minus the third, is wrong by three
// irregularities along each axis and the vector by one, 4 * 0.02 * sqrt(2) = 0.11 px; 0.15 is required.
TEST(WholeDisplacements, RevealWrongPredictor) {
  for (std::size_t const planted : {std::size_t{34}, std::size_t{0}})
    for (auto const& [correlation, threshold, replaced] :
         {std::tuple{0.5, 2.0, true}, std::tuple{0.75, 2.0, false},
          std::tuple{0.5, std::numeric_limits<double>::infinity(), false}}) {
      std::vector<GridVector> grid = smooth_grid(10, 6);
      Vec2d const truth = grid[planted].displacement;
      grid[planted].displacement += Vec2d{3.0, -2.0};
      for (GridVector& vector : grid) {
        vector.predictor = vector.displacement;
        vector.correlation = 0.8;
      }
      grid[planted].correlation = correlation;
      validate_vectors(grid, 10, {.displacement_threshold = threshold});
      for (std::size_t i = 0; i < grid.size(); ++i)
        EXPECT_EQ(grid[i].status, replaced && i == planted ? VectorStatus::replaced : VectorStatus::valid) << i;
      if (replaced) {
        EXPECT_LT(length(grid[planted].displacement - truth), 0.15);
      }
    }
  std::vector<GridVector> steep = smooth_grid(10, 6);
  for (std::size_t i = 0; i < steep.size(); ++i) {
    steep[i].displacement.x += 1.5 * static_cast<double>(i % 10);
    steep[i].predictor = steep[i].displacement;
    steep[i].correlation = i % 3 == 0 ? 0.4 : 0.8;
  }
  validate_vectors(steep, 10, {.displacement_threshold = 2.0});
  for (GridVector const& vector : steep) EXPECT_EQ(vector.status, VectorStatus::valid);
}

TEST(NormalisedMedian, LeavesVectorsWithoutNeighboursAlone) {
  std::vector<GridVector> grid = smooth_grid(2, 1);
  grid[1].displacement = {50.0, 50.0};
  validate_vectors(grid, 2, {});
  EXPECT_EQ(grid[1].status, VectorStatus::valid);
  EXPECT_EQ(grid[1].displacement.x, 50.0);
}

TEST(FilledDisplacement, ReachesEveryHoleAndKeepsWhatIsKnown) {
  std::vector<GridVector> grid = smooth_grid(9, 9);
  for (GridVector& vector : grid) {
    vector.displacement = {1.25, -0.5};
    vector.status = VectorStatus::invalid;
  }
  grid[40].status = VectorStatus::valid;
  for (Vec2d const value : filled_displacement(grid, 9)) EXPECT_EQ(value, (Vec2d{1.25, -0.5}));
  grid[40].status = VectorStatus::masked;
  for (Vec2d const value : filled_displacement(grid, 9)) EXPECT_EQ(value, (Vec2d{0.0, 0.0}));
}

TEST(SmoothedDisplacement, KeepsAPlaneAndDampsAZigzag) {
  std::vector<Vec2d> plane, zigzag;
  for (int j = 0; j < 7; ++j)
    for (int i = 0; i < 8; ++i) {
      plane.push_back({0.5 * i - 0.25 * j, 1.0 + 2.0 * j});
      zigzag.push_back({(i + j) % 2 == 0 ? 1.0 : -1.0, 0.0});
    }
  std::vector<Vec2d> const smooth = smoothed_displacement(plane, 8, 0.25);
  for (std::size_t i = 0; i < plane.size(); ++i) EXPECT_EQ(smooth[i], plane[i]);
  // the weights (1 6 1)/8 halve the shortest wave along each axis
  EXPECT_DOUBLE_EQ(smoothed_displacement(zigzag, 8, 0.25)[3 * 8 + 3].x, 0.25 * zigzag[3 * 8 + 3].x);
}

}  // namespace
}  // namespace gladstone
