#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "studies/benchmark/benchmark_results.h"
#include "studies/benchmark/benchmark_run.h"

namespace gladstone {
namespace {

/// Vectors every 8 px of an image of 256 x 256 px.
DisplacementField lattice() {
  DisplacementField field;
  for (int y = 4; y < 256; y += 8)
    for (int x = 4; x < 256; x += 8) {
      field.position_px.push_back({static_cast<double>(x), static_cast<double>(y)});
      field.displacement_px.push_back({});
      field.status.push_back(VectorStatus::valid);
    }
  return field;
}

// Positions 4, 12, ... 252: those from 36 to 220 are within 32 .. 223, 24 along each axis.
TEST(BenchmarkScore, IsThatOfKnownErrors) {
  DisplacementField field = lattice();
  std::vector<Vec2d> const truth = truth_at_vectors(field, sine_flow(64.0));
  for (std::size_t i = 0; i < field.size(); ++i) field.displacement_px[i] = 0.8 * truth[i];
  BenchmarkScore const followed = score_vectors(field, truth, 256, 256);
  EXPECT_EQ(followed.vectors, 576u);
  EXPECT_EQ(followed.errors.count(), 576u);
  EXPECT_EQ(followed.errors.count("gross"), 0u);
  EXPECT_NEAR(followed.gain, 0.8, 1e-12);
  // 24 positions 8 px apart are three whole waves of 64 px: the mean square of a sine is 1/2
  EXPECT_NEAR(followed.errors["rms_px"], 0.2 * std::sqrt(0.5), 1e-12);

  field.status[5 * 32 + 5] = VectorStatus::invalid;
  field.displacement_px[6 * 32 + 6] += Vec2d{1.5, 0.0};
  field.displacement_px[0] += Vec2d{9.0, 0.0};  // at the border: not counted
  BenchmarkScore const spoilt = score_vectors(field, truth, 256, 256);
  EXPECT_EQ(spoilt.vectors, 576u);
  EXPECT_EQ(spoilt.errors.count(), 575u);
  EXPECT_EQ(spoilt.errors.count("gross"), 1u);
  EXPECT_NEAR(spoilt.gain, 0.8, 1e-12);
  EXPECT_GT(spoilt.errors["rms_px"], spoilt.errors["rms_without_gross_px"]);
}

// Gaussian windows of standard deviation s respond to a step by the error function, which rises from 10 to 90 % within
// 2 * 1.2816 s. Vectors of an interval of 1 px are on average up to half a pixel from its centre, at either level.
TEST(BenchmarkCases, StepWidthIsThatOfAnErrorFunction) {
  constexpr double sigma = 8.0, height = 2.0;
  constexpr int pixels = 512;
  DisplacementAt const step = step_flow(height, pixels);
  Vec2d const along = step({500.0, 255.5}) / (0.5 * height), normal{along.y, -along.x};
  EXPECT_NEAR(length(along), 1.0, 1e-12);
  DisplacementField field;
  for (int y = 4; y < pixels; y += 8)
    for (int x = 4; x < pixels; x += 8) {
      Vec2d const p{static_cast<double>(x), static_cast<double>(y)};
      double const distance = dot(p - Vec2d{255.5, 255.5}, normal);
      EXPECT_GE(dot(step(p), along) * distance, 0.0);
      field.position_px.push_back(p);
      field.displacement_px.push_back(0.5 * height * std::erf(distance / (std::sqrt(2.0) * sigma)) * along);
      field.status.push_back(VectorStatus::valid);
    }
  EXPECT_NEAR(step_width_px(field, height, pixels), 2.0 * 1.2816 * sigma, 1.0);
  EXPECT_TRUE(std::isfinite(score_case(step_case, field, step, pixels, pixels).step_width_px));
  EXPECT_TRUE(std::isnan(score_case("uniform", field, step, pixels, pixels).step_width_px));
  for (Vec2d& d : field.displacement_px) d = {};
  EXPECT_TRUE(std::isnan(step_width_px(field, height, pixels))) << "no response";
}

// Displacements of neighbouring pixels differ by at most the peak gradient; somewhere by nearly as much: the direction
// of the largest gradient is at most 45 degrees from a row or a column.
TEST(BenchmarkCases, RandomFlowHasItsPeakGradient) {
  constexpr int pixels = 256;
  constexpr double gradient = 0.4;
  DisplacementAt const flow = random_flow({20.0, gradient, 7}, pixels);
  double steepest = 0.0;
  for (int y = 0; y + 1 < pixels; ++y)
    for (int x = 0; x + 1 < pixels; ++x) {
      Vec2d const p{static_cast<double>(x), static_cast<double>(y)}, here = flow(p);
      for (Vec2d const step : {Vec2d{1.0, 0.0}, Vec2d{0.0, 1.0}})
        steepest = std::max(steepest, length(flow(p + step) - here));
    }
  EXPECT_LT(steepest, 1.01 * gradient);  // the peak may be between the pixels at which it was scaled
  EXPECT_GT(steepest, gradient / std::sqrt(2.0));
  EXPECT_EQ(flow({3.0, 4.0}), random_flow({20.0, gradient, 7}, pixels)({3.0, 4.0}));
  EXPECT_NE(flow({3.0, 4.0}), random_flow({20.0, gradient, 8}, pixels)({3.0, 4.0}));
}

TEST(BenchmarkCases, AreOneListOfSeedsOfTheirOwn) {
  std::set<std::string> names;
  std::set<std::uint64_t> seeds;
  for (BenchmarkCase const& one : benchmark_cases()) {
    names.insert(one.name);
    seeds.insert(one.particles.seed);
    EXPECT_EQ(one.particles.columns, one.refracted() ? RefractedTurbulence::pixels : 1024) << one.name;
  }
  EXPECT_EQ(names.size(), benchmark_cases().size());
  EXPECT_EQ(seeds.size(), benchmark_cases().size());
  for (char const* name : {"uniform", "shear", "vortex", "sine_32", noise_case, gain_case, "loss_40", "dots_1.5",
                           "density_5", "light", "regular", "turbulence"})
    EXPECT_TRUE(names.contains(name)) << name;
}

// The documented keys and figures (docs/file-formats.md), for one estimator and both cases of the curve.
// DocumentedNames tests the columns.
TEST(BenchmarkResults, HaveTheDocumentedKeysAndFigures) {
  BenchmarkResult result;
  for (char const* const name : {noise_case, gain_case}) {
    BenchmarkRow row;
    row.estimator = "default";
    row.of_case = name;
    row.score.errors["rms_without_gross_px"] = 0.05;
    row.score.gain = 0.9;
    result.rows.push_back(row);
  }
  UncertaintyRow uncertainty;
  uncertainty.method = "peak_ratio";
  uncertainty.of_case = noise_case;
  UncertaintyBin bin;
  bin.rms_sigma_px = bin.rms_error_px = 0.05;
  uncertainty.bins = {bin};
  result.uncertainties = {uncertainty};
  result.coverage = {CoverageRow{}};

  auto const json = nlohmann::json::parse(benchmark_json(result));
  for (char const* const key : {"cases", "scores", "uncertainty", "coverage", "conventions", "likely_mistakes"})
    EXPECT_TRUE(json.contains(key)) << key;
  for (char const* const key : {"method", "case", "window_truth", "deformed_window_truth", "point_truth", "bins"})
    EXPECT_TRUE(json["uncertainty"][0].contains(key)) << key;
  for (std::string const truth : {"window", "deformed_window", "total"}) {
    for (std::string const measure : {"coverage_1_", "rms_ratio_"}) {
      auto const& mean = json["coverage"][0][measure + truth];
      EXPECT_TRUE(mean.contains("mean") && mean.contains("standard_error")) << measure << truth;
    }
  }

  std::filesystem::path const folder =
      std::filesystem::path(testing::TempDir()) / ("gladstone_benchmark_results_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  EXPECT_EQ(draw_benchmark(result, folder.string()),
            (std::vector<std::string>{"noise_against_gain.png", "error_against_uncertainty.png"}));
  for (char const* const figure : {"noise_against_gain.png", "error_against_uncertainty.png"})
    EXPECT_TRUE(std::filesystem::exists(folder / figure)) << figure;
  std::filesystem::remove_all(folder);
}

// Lamb & Oseen: the tangential velocity has its maximum, 5 px, at 1.1209 radii (2 s = exp(s) - 1 at s = 1.2564), and
// decreases as 1/r.
TEST(BenchmarkFlows, AreWhatTheirNamesSay) {
  DisplacementAt const vortex = vortex_flow(100.0, 1024);
  EXPECT_NEAR(vortex({511.5 + 112.09, 511.5}).y, 5.0, 1e-3);
  EXPECT_NEAR(vortex({511.5, 511.5 + 112.09}).x, -5.0, 1e-3);
  EXPECT_NEAR(vortex({511.5 + 450.0, 511.5}).y / vortex({511.5 + 500.0, 511.5}).y, 500.0 / 450.0, 1e-6);
  EXPECT_NEAR(shear_flow(0.02, 1024)({7.0, 611.5}).x, 2.0, 1e-12);
  EXPECT_NEAR(sine_flow(64.0)({0.0, 16.0}).x, 1.0, 1e-12);
}

// 40 % of some 1500 particles are lost: a binomial fraction with a standard deviation of 0.013; four of these.
TEST(ParticlePair, LosesThePartOfItsPairsThatItIsAskedTo) {
  auto const still = [](Vec2d) { return Vec2d{}; };
  ParticlePair const all = render_particle_pair({.columns = 192, .rows = 192}, still);
  ParticlePair const some = render_particle_pair({.columns = 192, .rows = 192, .lost = 0.4}, still);
  double const kept = static_cast<double>(some.dot_light.size()) / static_cast<double>(all.dot_light.size());
  EXPECT_NEAR(kept, 0.6, 0.052);
  // other particles replace them: equal light in both frames, to the scatter of 1500 particles
  auto const light = [](Image<double> const& image) {
    return std::accumulate(image.begin(), image.end(), 0.0, [](double sum, double v) { return sum + v - 25.5; });
  };
  EXPECT_NEAR(light(some.flow) / light(some.reference), 1.0, 0.1);
  EXPECT_NE(light(some.flow), light(some.reference));
}

// No displacement: frame B is frame A times the light, rounded to whole levels.
TEST(ParticlePair, ChangesTheLightFromLeftToRight) {
  ParticlePair const pair = render_particle_pair({.columns = 200, .rows = 64, .flow_light = 0.5, .light_slope = 0.6},
                                                 [](Vec2d) { return Vec2d{}; });
  for (int i : {0, 50, 100, 150, 199})
    for (int j = 0; j < 64; j += 7)
      EXPECT_NEAR(pair.flow(i, j), 0.5 * (1.0 + 0.6 * (i / 200.0 - 0.5)) * pair.reference(i, j), 1.0);
}

}  // namespace
}  // namespace gladstone
