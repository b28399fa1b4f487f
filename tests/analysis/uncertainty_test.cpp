#include "analysis/uncertainty/uncertainty.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "analysis/correlation/correlator.h"
#include "analysis/errors/uncertainty_quality.h"
#include "analysis/uncertainty/particle_pairs.h"
#include "analysis/uncertainty/pass_amplification.h"
#include "studies/benchmark/particle_pair.h"

namespace gladstone {
namespace {

HostFrames frames_of(ParticlePair const& pair) { return {pair.reference, pair.flow}; }

UncertaintyQuality quality_of(std::string const& method, std::function<Vec2d(Vec2d)> const& truth, double noise,
                              std::uint64_t seed) {
  ParticlePair const pair = render_particle_pair({.columns = 384, .rows = 384, .noise = noise, .seed = seed}, truth);
  CorrelationSettings settings;
  settings.uncertainty = method;
  DisplacementField field = make_correlator(settings)->correlate(pair.reference, pair.flow);
  estimate_uncertainty(field, frames_of(pair), settings);
  std::vector<Vec2d> right;
  for (Vec2d const& p : field.position_px) right.push_back(truth(p));
  return uncertainty_quality(field.displacement_px, right, field.sigma_px, {});
}

// Errors e = s r with known s and normal r: a fraction of 0.6827 lies within s, 0.9545 within 2 s. For 80,000 errors
// the standard errors of these fractions are 0.0016 and 0.0007, and that of the ratio of rms values is 0.0035; four
// standard errors are allowed. |e| = s |r| with s = 0.05 or 0.1 equally often: cov(s, |e|) = sqrt(2/pi) var(s),
// var(|e|) = E s^2 - (2/pi) (E s)^2, so that their correlation is sqrt(2/pi) 0.025/sqrt(0.00625 - 0.6366 0.005625) =
// 0.386.
TEST(UncertaintyQuality, IsThatOfNormalErrors) {
  std::mt19937_64 bits(5);
  std::normal_distribution<double> normal;
  std::vector<Vec2d> measured, truth, sigma;
  for (int i = 0; i < 40000; ++i) {
    double const s = i % 2 == 0 ? 0.05 : 0.1;
    truth.push_back({1.0, 2.0});
    sigma.push_back({s, s});
    measured.push_back(truth.back() + s * Vec2d{normal(bits), normal(bits)});
  }
  measured.push_back({5.0, 2.0});
  truth.push_back({1.0, 2.0});
  sigma.push_back({0.1, 0.1});
  UncertaintyQuality const quality = uncertainty_quality(measured, truth, sigma, {});
  EXPECT_EQ(quality.count, 80000u);
  EXPECT_EQ(quality.gross, 1u);
  EXPECT_NEAR(quality.coverage_1, 0.6827, 0.0064);
  EXPECT_NEAR(quality.coverage_2, 0.9545, 0.0028);
  EXPECT_NEAR(quality.rms_ratio, 1.0, 0.014);
  EXPECT_NEAR(quality.correlation, 0.386, 0.014);
}

// Four vectors without sigma, one of them a gross error: it counts as gross, and the others are counted, too.
TEST(UncertaintyQuality, CountsWhatItLeavesOut) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec2d> const truth(6, Vec2d{1.0, 2.0});
  std::vector<Vec2d> measured(6, Vec2d{1.1, 2.0}), sigma(6, Vec2d{nan, nan});
  measured[0] = measured[5] = {5.0, 2.0};
  sigma[4] = sigma[5] = {0.1, 0.1};
  UncertaintyQuality const quality = uncertainty_quality(measured, truth, sigma, {});
  EXPECT_EQ(quality.gross, 2u);
  EXPECT_EQ(quality.without_sigma, 3u);
  EXPECT_EQ(quality.count, 2u);
}

// Sigma from 0.01 to 0.1 and errors twice as large: each bin shows this, and the bins are in ascending order. Half of
// the components are gross or masked and do not appear.
TEST(UncertaintyBins, FollowTheErrors) {
  std::vector<Vec2d> measured, truth, sigma;
  VectorMask mask;
  for (int i = 0; i < 2000; ++i) {
    double const s = 0.01 + 0.09 * ((i * 7919) % 2000) / 2000.0;
    bool const right = i % 2 == 0;
    truth.push_back({1.0, 2.0});
    sigma.push_back({s, s});
    measured.push_back(truth.back() + (right ? 2.0 * s : 5.0) * Vec2d{1.0, -1.0});
    mask.push_back(i % 4 != 3);
  }
  std::vector<UncertaintyBin> const bins = uncertainty_bins(measured, truth, sigma, mask);
  ASSERT_EQ(bins.size(), 10u);
  for (std::size_t k = 0; k < bins.size(); ++k) {
    EXPECT_EQ(bins[k].count, 200u);
    EXPECT_NEAR(bins[k].rms_error_px / bins[k].rms_sigma_px, 2.0, 1e-9);
    if (k > 0) {
      EXPECT_GT(bins[k].rms_sigma_px, bins[k - 1].rms_sigma_px);
    }
  }
  double const mean_square = uncertainty_quality(measured, truth, sigma, mask).sharpness_px;
  // s is uniform on 0.01 .. 0.1: sqrt((0.1^3 - 0.01^3)/(3 0.09)) = 0.0608, to 1/1000 due to the finite number of values
  EXPECT_NEAR(mean_square, 0.0608, 2e-4);
  EXPECT_TRUE(uncertainty_bins({}, {}, {}, {}).empty());
}

// Half of all normal errors lie within 0.67 sigma; docs/estimators.md has the results of each method on 1024 px. For
// about 290 disjoint windows 0.68 scatters by 0.02 per component and seed.
TEST(Uncertainty, HasACaveatForMethodsWithTooSmallEstimates) {
  CorrelationSettings settings;
  EXPECT_EQ(uncertainty_caveat(settings), "");  // no uncertainty is estimated
  settings.uncertainty = "correlation_statistics";
  EXPECT_EQ(uncertainty_caveat(settings), "");
  for (std::string const method : {"rpc", "spc", "dis", "horn_schunck"}) {
    settings.method = method;
    EXPECT_NE(uncertainty_caveat(settings).find('"' + method + '"'), std::string::npos);
  }
  settings.method = "mqd";
  settings.window_px = {32};
  settings.final_passes = 1;
  EXPECT_NE(uncertainty_caveat(settings), "") << "a single pass";
  settings.final_passes = 2;
  EXPECT_EQ(uncertainty_caveat(settings), "");
}

TEST(CorrelationStatistics, CoversTwoThirdsOfTheErrors) {
  auto const vortex = [](Vec2d p) { return Vec2d{-0.02 * (p.y - 192.0), 0.02 * (p.x - 192.0)}; };
  for (double const noise : {0.01, 0.05, 0.1}) {
    UncertaintyQuality const quality = quality_of("correlation_statistics", vortex, noise, 101);
    EXPECT_NEAR(quality.coverage_1, 0.68, 0.06) << noise;
    EXPECT_NEAR(quality.coverage_2, 0.95, 0.03) << noise;
    EXPECT_NEAR(quality.rms_ratio, 1.0, 0.15) << noise;
  }
}

// A flickering lamp with uneven light: dots and background of frame B are half as bright, times 0.7 to 1.3 along a row.
// Over a window the slope, 0.6 over 384 px times 20 px, is a difference of 3 %, compared with noise of 5 %.
TEST(Uncertainty, IsTheSameInFramesOfOtherBrightness) {
  auto const uniform = [](Vec2d) { return Vec2d{0.3, -0.7}; };
  ParticleSettings particles{.columns = 384, .rows = 384, .noise = 0.05, .seed = 103};
  ParticlePair const even = render_particle_pair(particles, uniform);
  ParticlePair uneven = even;
  for (int j = 0; j < particles.rows; ++j)
    for (int i = 0; i < particles.columns; ++i) uneven.flow(i, j) *= 0.5 * (0.7 + 0.6 * i / 384.0);
  for (char const* method : {"correlation_statistics", "image_matching", "moment_of_correlation"}) {
    CorrelationSettings settings;
    settings.uncertainty = method;
    auto const mean_square = [&](ParticlePair const& pair) {
      DisplacementField field = make_correlator(settings)->correlate(pair.reference, pair.flow);
      estimate_uncertainty(field, frames_of(pair), settings);
      double sum = 0.0;
      for (Vec2d const& sigma : field.sigma_px) sum += std::isfinite(sigma.x) ? dot(sigma, sigma) : 0.0;
      return sum;
    };
    EXPECT_NEAR(std::sqrt(mean_square(uneven) / mean_square(even)), 1.0, 0.03) << method;
  }
}

TEST(ImageMatching, CoversTwoThirdsOfTheErrorsInNoise) {
  auto const uniform = [](Vec2d) { return Vec2d{0.3, -0.7}; };
  for (double const noise : {0.01, 0.05, 0.1}) {
    UncertaintyQuality const quality = quality_of("image_matching", uniform, noise, 102);
    EXPECT_NEAR(quality.coverage_1, 0.68, 0.07) << noise;
    EXPECT_NEAR(quality.rms_ratio, 1.0, 0.2) << noise;
  }
}

// Two overlapping dots of different brightness: in equal frames their displacement is 0, although the light of the
// neighbour shifts their maxima. In frames that are displaced by 0.05 px both have this displacement, to the accuracy
// of slopes over two pixels of such small dots: for a single dot Simpson's (2 + cos k)/3 instead of sin(k)/k, over the
// spectrum k^2 exp(-(0.75 k)^2) of the slopes, is 4 % too large; three times as much is allowed.
TEST(ParticlePairs, AreNotMisledByNeighboursLight) {
  for (double const shift : {0.0, 0.05}) {
    MatchedWindow window{24, std::vector<float>(576), std::vector<float>(576), std::vector<float>(576, 1.0f)};
    auto const light = [](double x, double y) {
      auto const dot = [&](double cx, double cy) {
        return std::exp(-((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (2.0 * 0.75 * 0.75));
      };
      return dot(10.2, 11.7) + 0.6 * dot(13.1, 12.4);
    };
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) {
        window.reference[window.at(i, j)] = static_cast<float>(light(i + 0.5 * shift, j));
        window.flow[window.at(i, j)] = static_cast<float>(light(i - 0.5 * shift, j));
      }
    std::vector<ParticleImagePair> pairs;
    find_particle_pairs(window, pairs);
    ASSERT_EQ(pairs.size(), 2u);
    for (ParticleImagePair const& pair : pairs) {
      EXPECT_NEAR(pair.disparity.x, shift, shift == 0.0 ? 1e-6 : 0.12 * shift);
      EXPECT_NEAR(pair.disparity.y, 0.0, shift == 0.0 ? 1e-6 : 0.12 * shift);
    }
  }
}

// A dot of a target with a flat top: three points near the maximum contain only noise, while the edge of the dot
// determines its position. The best estimate scatters by sqrt(2) s/sqrt(sum (dI/dx)^2) for noise s (Cramer-Rao bound,
// both frames noisy). 1000 dots determine the scatter to 2 %; half as much again is allowed.
TEST(ParticlePairs, OfFlatDotsScatterAsTheirEdgesLet) {
  double const noise = 0.02, profile[] = {0.0, 0.1, 0.9, 1.0, 0.9, 0.1, 0.0};
  std::mt19937_64 bits(8);
  std::normal_distribution<double> normal(0.0, noise);
  double gradients = 0.0;
  for (double const y : profile)
    for (int i = 1; i < 6; ++i)
      gradients += 0.25 * (profile[i + 1] - profile[i - 1]) * (profile[i + 1] - profile[i - 1]) * y * y;
  double sum = 0.0, count = 0.0;
  for (int dot = 0; dot < 1000; ++dot) {
    MatchedWindow window{15, std::vector<float>(225), std::vector<float>(225), std::vector<float>(225, 1.0f)};
    for (std::vector<float>* frame : {&window.reference, &window.flow})
      for (int j = 0; j < 15; ++j)
        for (int i = 0; i < 15; ++i) {
          bool const inside = i >= 4 && i <= 10 && j >= 4 && j <= 10;
          double const value = inside ? profile[i - 4] * profile[j - 4] : 0.0;
          (*frame)[window.at(i, j)] = static_cast<float>(value + normal(bits));
        }
    std::vector<ParticleImagePair> pairs;
    find_particle_pairs(window, pairs);
    for (ParticleImagePair const& pair : pairs) {
      if (pair.weight < 0.5) continue;  // noise around the dot
      sum += pair.disparity.x * pair.disparity.x;
      count += 1.0;
    }
  }
  EXPECT_GT(count, 900.0);
  EXPECT_LT(std::sqrt(sum / count), 1.5 * std::sqrt(2.0) * noise / std::sqrt(gradients));
}

/// Results of three pairs of 384 px, uniform displacement.
UncertaintyQuality quality_of_dots(std::string const& method, double diameter_px, double per_window, double noise) {
  std::vector<Vec2d> measured, truth, sigma;
  for (std::uint64_t seed = 201; seed < 204; ++seed) {
    Vec2d const shift{0.3, -0.3 + 0.29 * static_cast<double>(seed - 201)};
    ParticlePair const pair = render_particle_pair({.columns = 384,
                                                    .rows = 384,
                                                    .diameter_px = diameter_px,
                                                    .particles_per_px = per_window / 1024.0,
                                                    .noise = noise,
                                                    .seed = seed},
                                                   [&](Vec2d) { return shift; });
    CorrelationSettings settings;
    settings.uncertainty = method;
    DisplacementField field = make_correlator(settings)->correlate(pair.reference, pair.flow);
    estimate_uncertainty(field, frames_of(pair), settings);
    for (std::size_t i = 0; i < field.size(); ++i) {
      Vec2d const at = field.position_px[i];
      if (field.status[i] != VectorStatus::valid || std::min(at.x, at.y) < 32 || std::max(at.x, at.y) > 351) continue;
      measured.push_back(field.displacement_px[i]);
      truth.push_back(shift);
      sigma.push_back(field.sigma_px[i]);
    }
  }
  return uncertainty_quality(measured, truth, sigma, {});
}

struct Dots {
  double diameter_px, per_window, noise;
};

// docs/estimators.md has the whole table. For about 190 disjoint windows in each of three pairs and two components,
// 0.68 scatters by 0.014 and the ratio by 0.02; the required ranges are 0.62 to 0.74 and 0.85 to 1.15.
TEST(CorrelationStatistics, HoldsForDotsOfEverySizeAndDensity) {
  for (Dots const& dots : {Dots{1.5, 20, 0.05},
                           {4.5, 20, 0.05},
                           {6.0, 20, 0.01},
                           {6.0, 20, 0.05},
                           {3.0, 40, 0.05},
                           {3.0, 5, 0.05},
                           {6.0, 5, 0.05}}) {
    UncertaintyQuality const quality =
        quality_of_dots("correlation_statistics", dots.diameter_px, dots.per_window, dots.noise);
    EXPECT_NEAR(quality.coverage_1, 0.68, 0.06) << dots.diameter_px << ' ' << dots.per_window << ' ' << dots.noise;
    EXPECT_NEAR(quality.rms_ratio, 1.0, 0.15) << dots.diameter_px << ' ' << dots.per_window << ' ' << dots.noise;
  }
}

// Coverage rates as in the previous test; every vector has a sigma.
TEST(ImageMatching, HoldsForDotsUpToItsPatch) {
  for (Dots const& dots : {Dots{1.5, 20, 0.05}, {3.0, 20, 0.05}, {4.5, 20, 0.05}, {4.5, 20, 0.01}, {3.0, 40, 0.05}}) {
    UncertaintyQuality const quality = quality_of_dots("image_matching", dots.diameter_px, dots.per_window, dots.noise);
    EXPECT_NEAR(quality.coverage_1, 0.68, 0.06) << dots.diameter_px << ' ' << dots.per_window << ' ' << dots.noise;
    EXPECT_NEAR(quality.rms_ratio, 1.0, 0.15) << dots.diameter_px << ' ' << dots.per_window << ' ' << dots.noise;
    EXPECT_EQ(quality.without_sigma, 0u) << dots.diameter_px;
  }
  UncertaintyQuality const large = quality_of_dots("image_matching", 6.0, 20, 0.05);
  EXPECT_EQ(large.without_sigma, 0u) << "with the dots of single windows only, a quarter had none";
}

// Two passes of one Gaussian window H = exp(-a r^2) with an exact predictor: A = 2 H - H^2, and the integrals of A^2
// and H^2 over the plane are pi/a (4/2 - 4/3 + 1/4) and pi/a 1/2, a ratio of 11 to 6. Nodes 2 px apart cause almost no
// loss for windows of 32 px.
TEST(PassAmplification, IsThatOfTheRecursion) {
  CorrelationSettings settings;
  settings.window_px = {32};
  EXPECT_NEAR(amplification_of_passes(settings), 1.0, 1e-12);
  settings.final_passes = 2;
  settings.overlap = 0.95;
  EXPECT_NEAR(amplification_of_passes(settings), std::sqrt(11.0 / 6.0), 0.005);
  settings.method = "dis";
  EXPECT_EQ(amplification_of_passes(settings), 1.0);
}

// Ten times the noise causes about ten times the error, and the estimate of every method that uses the images
// increases.
TEST(EveryUncertainty, GrowsWithNoise) {
  auto const shear = [](Vec2d p) { return Vec2d{0.01 * (p.y - 192.0), 0.0}; };
  for (std::string const& method : uncertainty_methods()) {
    double sigma[2];
    for (int k = 0; k < 2; ++k) {
      UncertaintyQuality const quality = quality_of(method, shear, k == 0 ? 0.01 : 0.1, 103);
      EXPECT_GT(quality.count, 3000u) << method;
      sigma[k] = quality.rms_ratio * (k == 0 ? 0.008 : 0.09);
      EXPECT_GT(sigma[k], 0.0) << method;
    }
    EXPECT_GT(sigma[1], 1.2 * sigma[0]) << method;
  }
}

TEST(EveryUncertainty, IsNotKnownWhereNothingWasMeasured) {
  ParticlePair pair = render_particle_pair({.noise = 0.02}, [](Vec2d) { return Vec2d{0.3, -0.7}; });
  for (int j = 80; j < 150; ++j)
    for (int i = 80; i < 150; ++i) pair.flow(i, j) = std::numeric_limits<double>::quiet_NaN();
  for (std::string const& method : uncertainty_methods()) {
    CorrelationSettings settings;
    settings.uncertainty = method;
    DisplacementField field = make_correlator(settings)->correlate(pair.reference, pair.flow);
    estimate_uncertainty(field, frames_of(pair), settings);
    std::size_t known = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
      bool const has_sigma = std::isfinite(field.sigma_px[i].x) && std::isfinite(field.sigma_px[i].y);
      known += has_sigma;
      if (field.status[i] != VectorStatus::valid) {
        EXPECT_FALSE(has_sigma) << method;
      }
    }
    EXPECT_GT(known, field.size() / 2) << method;
  }
}

// "auto" selects correlation statistics on a CPU, except where uncertainty_caveat() calls them too small.
TEST(UncertaintySettings, AutoSelectsAMethodThatIsCheapAndValid) {
  auto const chosen = [](std::string const& method, bool on_cpu, std::vector<int> windows = {32, 16}) {
    CorrelationSettings settings;
    settings.method = method;
    settings.window_px = std::move(windows);
    settings.uncertainty = "auto";
    EXPECT_FALSE(settings.estimates_uncertainty());
    return choose_uncertainty(settings, on_cpu).uncertainty;
  };
  EXPECT_EQ(chosen("scc", true), "correlation_statistics");
  EXPECT_EQ(chosen("zncc", true), "correlation_statistics");
  EXPECT_EQ(chosen("scc", false), "none");
  EXPECT_EQ(chosen("scc", true, {32}), "none");
  for (char const* method : {"rpc", "spc", "dis", "tracking"}) EXPECT_EQ(chosen(method, true), "none") << method;
  CorrelationSettings given;
  given.uncertainty = "image_matching";
  EXPECT_EQ(choose_uncertainty(given, false).uncertainty, "image_matching");
}

// A reader of the vectors sees which method was used although the setup says "auto", and why it was none.
TEST(UncertaintySettings, AreRecordedWithTheKeyThatSelectedTheMethod) {
  using enum CorrelatedFrames;
  auto const recorded = [](CorrelationSettings const& settings, CorrelatedFrames frames) {
    DisplacementField field;
    record_uncertainty(field, settings, frames);
    return field.uncertainty_method + " by " + field.uncertainty_key;
  };
  CorrelationSettings settings;
  settings.uncertainty = "auto";
  EXPECT_EQ(recorded(settings, pair_on_cpu), "correlation_statistics by correlate.uncertainty = \"auto\"");
  EXPECT_EQ(recorded(settings, pair_on_gpu), "none by correlate.uncertainty = \"auto\" (on a GPU)");
  EXPECT_EQ(recorded(settings, sequence), "none by correlate.uncertainty = \"auto\" (sequence)");
  settings.method = "rpc";
  EXPECT_EQ(recorded(settings, pair_on_cpu), "none by correlate.uncertainty = \"auto\" (correlate.method = \"rpc\")");
  settings.method = "tracking";
  EXPECT_EQ(recorded(settings, sequence), "dot_fit by correlate.method = \"tracking\"");
  settings.method = "scc";
  settings.window_px = {32};
  EXPECT_EQ(recorded(settings, pair_on_cpu),
            "none by correlate.uncertainty = \"auto\" (correlate.window_px has a single pass)");
  settings.uncertainty = "image_matching";
  EXPECT_EQ(recorded(settings, sequence), "image_matching by correlate.uncertainty = \"image_matching\"");
}

}  // namespace
}  // namespace gladstone
