#include "analysis/correlation/correlation_methods.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "analysis/correlation/correlator.h"
#include "studies/benchmark/particle_pair.h"

namespace gladstone {
namespace {

CorrelationSettings one_pass(std::string const& method, std::string const& weighting = "gaussian") {
  CorrelationSettings settings;
  settings.window_px = {32};
  settings.overlap = 0.5;
  settings.method = method;
  settings.weighting = weighting;
  return settings;
}

/// Root mean square error per component, and the mean error along x.
struct MethodError {
  double rms = 0.0;
  double bias = 0.0;
};

MethodError error_of(CorrelationSettings const& settings, double shift, double noise) {
  ParticlePair const pair = render_particle_pair({.noise = noise}, [shift](Vec2d) { return Vec2d{shift, -shift}; });
  DisplacementField const field = make_correlator(settings)->correlate(pair.reference, pair.flow);
  MethodError error;
  double count = 0.0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d const e = field.displacement_px[i] - Vec2d{shift, -shift};
    error.rms += 0.5 * dot(e, e);
    error.bias += e.x;
    count += 1.0;
  }
  return {std::sqrt(error.rms / count), error.bias / count};
}

// OpenCV computes the plane by other transforms: 24 bits over a plane of 48^2 or 64^2 values cause errors of 1e-6 of
// the peak, whose width is about a pixel; ten times that for peaks on the flank of other peaks.
TEST(Scc, IsOpenCVsPlaneToTenMicropixels) {
  ParticlePair const pair = render_particle_pair({.noise = 0.05}, [](Vec2d p) {
    return Vec2d{1.7 + std::sin(0.05 * p.y), -0.02 * p.x};
  });
  ParticlePair holed = pair;
  for (int j = 90; j < 120; ++j)
    for (int i = 40; i < 75; ++i) holed.flow(i, j) = std::numeric_limits<double>::quiet_NaN();
  for (ParticlePair const* images : {&pair, static_cast<ParticlePair const*>(&holed)})
    for (char const* weighting : {"gaussian", "uniform"})
      for (int const window : {8, 12, 20, 22, 32, 46, 64}) {
        CorrelationSettings fast = one_pass("scc", weighting), slow = one_pass("opencv", weighting);
        fast.window_px = slow.window_px = {window};
        DisplacementField const a = make_correlator(fast)->correlate(images->reference, images->flow);
        DisplacementField const b = make_correlator(slow)->correlate(images->reference, images->flow);
        ASSERT_EQ(a.size(), b.size());
        std::size_t different = 0, other_rivals = 0;
        for (std::size_t i = 0; i < a.size(); ++i) {
          EXPECT_EQ(std::isnan(a.raw_px[i].x), std::isnan(b.raw_px[i].x));
          different += length(a.raw_px[i] - b.raw_px[i]) > 1e-4;
          // there the interpolated height of every maximum, here only of those that can be among the highest
          other_rivals += std::abs(a.peak_ratio[i] - b.peak_ratio[i]) > 1e-3 * b.peak_ratio[i];
        }
        // two peaks of equal height may be in either order if windows contain few dots
        EXPECT_LE(different, a.size() / 500) << weighting << ' ' << window;
        // for uniform windows of 32 px and more the line beyond the search range wraps around (plane_transform_size()):
        // if the secondary peak is a maximum at the edge of the range, one position in eight, its height may differ
        bool const rim_wraps = weighting == std::string("uniform") && window >= 32;
        EXPECT_LE(other_rivals, a.size() / (rim_wraps ? 8 : 500)) << weighting << ' ' << window;
        EXPECT_EQ(std::count(a.status.begin(), a.status.end(), VectorStatus::masked),
                  std::count(b.status.begin(), b.status.end(), VectorStatus::masked));
      }
}

// Errors in one pass at 32 px (docs/estimators.md), plus a third for 256 px instead of 1024.
TEST(EveryMethod, MeasuresAShift) {
  for (auto const& [method, clean, noisy] : {std::tuple{"scc", 0.025, 0.037},
                                             {"rpc", 0.0055, 0.037},
                                             {"spc", 0.017, 0.042},
                                             {"zncc", 0.025, 0.037},
                                             {"mqd", 0.025, 0.037}}) {
    EXPECT_LT(error_of(one_pass(method), 0.3, 0.0).rms, clean) << method;
    EXPECT_LT(error_of(one_pass(method), 0.3, 0.05).rms, noisy) << method;
    EXPECT_LT(error_of(one_pass(method), 4.6, 0.0).rms, 0.05) << method;
  }
}

// Result of Eckstein & Vlachos: a few thousandths of a pixel in one pass, without peak locking.
TEST(Rpc, ErrsByThousandthsOfAPixelInOnePass) {
  for (double const shift : {0.0, 0.25, 0.5, 0.8}) {
    MethodError const error = error_of(one_pass("rpc"), shift, 0.0);
    EXPECT_LT(error.rms, 0.007) << shift;
    EXPECT_LT(std::abs(error.bias), 0.005) << shift;
  }
}

// The quadratic difference of a frame with itself is 0, so that the coefficient of every method is 1. The mean has no
// phase: rpc omits that wavenumber, exp(0) of a filter whose sum over 64 x 64 waves is 370.
TEST(NormalisedMethods, GiveOneForTheSameFrame) {
  ParticlePair const pair = render_particle_pair({}, [](Vec2d) { return Vec2d{}; });
  for (char const* method : {"zncc", "mqd", "scc", "rpc", "spc"})
    for (char const* weighting : {"gaussian", "uniform"}) {
      DisplacementField const field =
          make_correlator(one_pass(method, weighting))->correlate(pair.reference, pair.reference);
      for (std::size_t i = 0; i < field.size(); ++i) {
        EXPECT_NEAR(field.correlation[i], 1.0, 4e-3) << method << weighting;
        EXPECT_LT(length(field.displacement_px[i]), 1e-3) << method << weighting;
      }
    }
}

// Three times the light in one frame changes nothing: every method subtracts the means and divides by the energies,
// except mqd. The remaining error is the rounding of float in the transforms, some tens of times 6e-8 of a peak whose
// curvature is a tenth of its height: 1e-4 px for scc. zncc divides by two more planes, of energies over the whole
// bright level, each with the same error: 5e-4 px. Wavenumber 0 does not depend on the means and contains only rounding
// errors: its phase must not count in rpc, where it changed vectors by 2e-3 px.
TEST(EveryMethod, TakesItsGreyLevelsRelatively) {
  ParticlePair const pair = render_particle_pair({}, [](Vec2d) { return Vec2d{0.4, 1.3}; });
  ParticlePair bright = pair;
  for (double& value : bright.flow) value = 3.0 * value + 40.0;
  for (char const* method : {"scc", "rpc", "spc", "zncc"}) {
    auto const correlator = make_correlator(one_pass(method));
    DisplacementField const a = correlator->correlate(pair.reference, pair.flow);
    DisplacementField const b = correlator->correlate(bright.reference, bright.flow);
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_LT(length(a.displacement_px[i] - b.displacement_px[i]), method == std::string("zncc") ? 5e-4 : 1e-4)
          << method;
  }
}

// Frames in other units of light, 1e-9 or 1e12 of a grey level, are equivalent: a factor that is a power of two changes
// no digit and no bit of the result. 8 bits as 16 bits (257 times) are rounded differently: 6e-8 of a peak, some
// hundred times; zncc and mqd transform energies together with weights and have the rounding error of the larger: 5e-4
// px, as above.
TEST(EveryMethod, MeasuresInAnyUnitOfLight) {
  ParticlePair const pair = render_particle_pair({.columns = 128, .rows = 128}, [](Vec2d) { return Vec2d{0.4, 1.3}; });
  for (std::string const method : {"scc", "rpc", "spc", "zncc", "mqd"})
    for (double const unit : {0x1p-30, 257.0, 0x1p40}) {
      ParticlePair scaled = pair;
      for (Image<double>* image : {&scaled.reference, &scaled.flow})
        for (double& value : *image) value *= unit;
      auto const correlator = make_correlator(one_pass(method.c_str()));
      DisplacementField const a = correlator->correlate(pair.reference, pair.flow);
      DisplacementField const b = correlator->correlate(scaled.reference, scaled.flow);
      double const most = unit != 257.0 ? 0.0 : method == "zncc" || method == "mqd" ? 5e-4 : 1e-5;
      for (std::size_t i = 0; i < a.size(); ++i)
        EXPECT_LE(length(a.displacement_px[i] - b.displacement_px[i]), most) << method << ' ' << unit;
    }
}

// The settings that a GPU does not support: --device cuda reports them as an error, --device auto uses the CPU.
TEST(MissingOnGpu, IsEverythingButSccAndRpcByGaussians) {
  CorrelationSettings settings;
  for (char const* subpixel : {"gauss3", "gauss2d"}) {
    settings.subpixel = subpixel;
    EXPECT_EQ(missing_on_gpu(settings), "");
  }
  settings.subpixel = "parabola";
  EXPECT_EQ(missing_on_gpu(settings), "subpixel = \"parabola\"");
  settings = {};
  settings.deformation = "sinc";
  EXPECT_EQ(missing_on_gpu(settings), "deformation = \"sinc\"");
  for (std::string const& method : correlation_methods())
    EXPECT_EQ(missing_on_gpu(one_pass(method)),
              method == "scc" || method == "rpc" ? "" : "method = \"" + method + "\"");
}

// A threshold of the correlation that a hundred windows do not reach rejects these, and "off" rejects none.
TEST(LeastCorrelation, TakesOutWhatIsBelow) {
  ParticlePair const pair = render_particle_pair({.noise = 0.1}, [](Vec2d) { return Vec2d{0.4, 1.3}; });
  CorrelationSettings settings = one_pass("scc");
  DisplacementField const all = make_correlator(settings)->correlate(pair.reference, pair.flow);
  std::vector<double> sorted = all.correlation;
  std::nth_element(sorted.begin(), sorted.begin() + 100, sorted.end());
  settings.least_correlation = sorted[100];
  DisplacementField const some = make_correlator(settings)->correlate(pair.reference, pair.flow);
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all.status[i], VectorStatus::valid);
    EXPECT_EQ(some.status[i] == VectorStatus::valid, all.correlation[i] >= sorted[100]);
  }
}

TEST(MedianThreshold, Off) {
  ParticlePair const pair = render_particle_pair({.particles_per_px = 5.0 / 1024.0, .noise = 0.1}, [](Vec2d) {
    return Vec2d{0.4, 1.3};
  });
  CorrelationSettings settings;
  settings.median_threshold.reset();
  settings.displacement_threshold.reset();
  DisplacementField const field = make_correlator(settings)->correlate(pair.reference, pair.flow);
  EXPECT_EQ(std::count(field.status.begin(), field.status.end(), VectorStatus::replaced), 0);
}

// Without the median test no other peak is preferred: vectors below a threshold are replaced by their neighbours, never
// by a lower peak of the same window.
TEST(MedianThreshold, OffLeavesReplacementToTheNeighbours) {
  ParticlePair const pair = render_particle_pair({.noise = 0.03}, [](Vec2d) { return Vec2d{0.3, -0.3}; });
  for (auto const level : {&CorrelationSettings::least_peak_ratio, &CorrelationSettings::least_correlation}) {
    CorrelationSettings settings;
    settings.median_threshold.reset();
    settings.*level = level == &CorrelationSettings::least_peak_ratio ? 3.0 : 0.88;
    DisplacementField const field = make_correlator(settings)->correlate(pair.reference, pair.flow);
    std::size_t replaced = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
      if (field.status[i] != VectorStatus::replaced) continue;
      ++replaced;
      EXPECT_EQ(field.reason[i], VectorReason::neighbours);
      EXPECT_LT(length(field.displacement_px[i] - Vec2d{0.3, -0.3}), 0.1);
    }
    EXPECT_GT(replaced, 0u);
    EXPECT_LT(replaced, field.size());
  }
}

}  // namespace
}  // namespace gladstone
