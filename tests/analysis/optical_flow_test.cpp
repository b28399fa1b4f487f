#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/optical_flow/dense_flow.h"
#include "analysis/correlation/standard_correlator.h"
#include "render/base/error.h"
#include "studies/benchmark/particle_pair.h"
#include "tests/support/expect_error.h"
#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

constexpr char const* flows[] = {"dis", "horn_schunck"};

CorrelationSettings by_flow(std::string const& method) {
  CorrelationSettings settings;
  settings.method = method;
  return settings;
}

// (1 4 6 4 1)/16 preserves linear functions, and every other pixel is retained, beginning with 0: x becomes 2 x.
TEST(Pyramid, PutsPixelIWherePixelTwoIWas) {
  GreyImage ramp{97, 60, {}};
  for (int j = 0; j < ramp.rows; ++j)
    for (int i = 0; i < ramp.columns; ++i) ramp.level.push_back(static_cast<float>(i + 3 * j));
  std::vector<GreyImage> const levels = build_pyramid(ramp);
  ASSERT_EQ(levels.size(), 2u);  // half of 60 is 30: another half would be below 24
  EXPECT_EQ(levels[1].columns, 49);
  EXPECT_EQ(levels[1].rows, 30);
  for (int j = 1; j + 1 < 29; ++j)
    for (int i = 1; i + 1 < 48; ++i) EXPECT_NEAR(levels[1](i, j), 2 * i + 6 * j, 1e-4);
}

// Errors on 1024 px (docs/estimators.md), plus half as much again for 256 px.
TEST(EveryOpticalFlow, MeasuresAShift) {
  for (char const* method : flows)
    for (Vec2d const shift : {Vec2d{0.3, -0.3}, Vec2d{6.4, 2.2}}) {
      ParticlePair const pair = render_particle_pair({}, [shift](Vec2d) { return shift; });
      DisplacementField const field = make_correlator(by_flow(method))->correlate(pair.reference, pair.flow);
      double squares = 0.0, count = 0.0;
      for (std::size_t i = 0; i < field.size(); ++i) {
        Vec2d const at = field.position_px[i];
        if (std::min(at.x, at.y) < 32.0 || std::max(at.x, at.y) > 223.0) continue;
        EXPECT_EQ(field.status[i], VectorStatus::valid);
        Vec2d const e = field.displacement_px[i] - shift;
        squares += 0.5 * dot(e, e);
        count += 1.0;
      }
      EXPECT_LT(std::sqrt(squares / count), 0.04) << method << ' ' << shift.x;
    }
}

// u = 0.06 (x - 127.5): at position c of the reference the displacement is u(c + u/2) = 0.0619 (c - 127.5), 3 % more
// than u(c). Some 700 vectors determine a slope over 256 px to sqrt(12) 0.06/(256 sqrt(700)) = 3e-5; patches of 16 px
// that are stretched by 1 px fit slightly worse on one side. Half of the difference, 0.0009, distinguishes the two.
TEST(EveryOpticalFlow, BelongsToMidPosition) {
  for (char const* method : flows) {
    ParticlePair const pair = render_particle_pair({}, [](Vec2d p) { return Vec2d{0.06 * (p.x - 127.5), 0.0}; });
    DisplacementField const field = make_correlator(by_flow(method))->correlate(pair.reference, pair.flow);
    double xx = 0.0, xu = 0.0;
    for (std::size_t i = 0; i < field.size(); ++i) {
      Vec2d const at = field.position_px[i];
      if (std::min(at.x, at.y) < 48.0 || std::max(at.x, at.y) > 207.0) continue;
      xx += (at.x - 127.5) * (at.x - 127.5);
      xu += (at.x - 127.5) * field.displacement_px[i].x;
    }
    EXPECT_NEAR(xu / xx, 0.06, 9e-4) << method;
  }
}

TEST(EveryOpticalFlow, SaysWhatItDoesNotKnow) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  ParticlePair pair = render_particle_pair({}, [](Vec2d) { return Vec2d{0.3, 0.1}; });
  for (int j = 0; j < 256; ++j)
    for (int i = 0; i < 100; ++i) pair.flow(i, j) = nan;
  Image<double> const dark(256, 256, 7.0);
  for (char const* method : flows) {
    DisplacementField const half = make_correlator(by_flow(method))->correlate(pair.reference, pair.flow);
    for (std::size_t i = 0; i < half.size(); ++i) {
      // windows are 20 px wide: half of a window is masked if its centre is less than pixel 99.5
      bool const unknown = half.position_px[i].x <= 99.5;
      EXPECT_EQ(half.status[i], unknown ? VectorStatus::masked : VectorStatus::valid) << half.position_px[i].x;
      EXPECT_EQ(std::isnan(half.displacement_px[i].x), unknown);
      EXPECT_TRUE(std::isnan(half.peak_ratio[i]));
      EXPECT_TRUE(std::isnan(half.correlation[i]));
    }
    DisplacementField const nothing = make_correlator(by_flow(method))->correlate(dark, dark);
    for (std::size_t i = 0; i < nothing.size(); ++i) EXPECT_EQ(nothing.reason[i], VectorReason::no_signal);
    CorrelationSettings tight = by_flow(method);
    tight.max_displacement_px = 0.1;
    ParticlePair const moved = render_particle_pair({}, [](Vec2d) { return Vec2d{0.5, 0.0}; });
    DisplacementField const beyond = make_correlator(tight)->correlate(moved.reference, moved.flow);
    EXPECT_EQ(beyond.reason[beyond.size() / 2], VectorReason::beyond_limit) << method;
  }
}

TEST(EveryOpticalFlow, NamesSettingsThatItDoesNotHeed) {
  ParticlePair const pair = render_particle_pair({.columns = 96, .rows = 96}, [](Vec2d) { return Vec2d{0.3, 0.1}; });
  for (char const* method : flows) {
    CorrelationSettings settings = by_flow(method);
    EXPECT_TRUE(make_correlator(settings)->correlate(pair.reference, pair.flow).warnings.empty());
    settings.subpixel = "gauss2d";
    settings.least_peak_ratio = 1.2;
    auto const warnings = make_correlator(settings)->correlate(pair.reference, pair.flow).warnings;
    ASSERT_EQ(warnings.size(), 1u) << method;
    EXPECT_THAT(warnings[0], Warns("ignored at correlate.method",
                                   testing::HasSubstr("correlate.subpixel, correlate.least_peak_ratio")));
  }
}

// Both frames are converted with the same grey levels, which a few bright pixels (four of 131,072; one in 10,000 would
// be 13) do not affect.
TEST(InverseSearch, ScalesBothFramesTogether) {
  GreyImage dark{256, 256, std::vector<float>(65536, 100.0f)}, bright{256, 256, std::vector<float>(65536, 900.0f)};
  bright.level[5] = bright.level[77] = dark.level[9] = dark.level[4000] = 60000.0f;
  dark.level[123] = 40.0f;
  GreyRange const range = joint_range(dark, bright);
  EXPECT_EQ(range.low, 40.0f);
  EXPECT_EQ(range.high, 900.0f);
  GreyImage const one_dot{256, 256, [] {
                            std::vector<float> level(65536, 1.0f);
                            level[300] = 7.0f;
                            return level;
                          }()};
  EXPECT_EQ(joint_range(one_dot, one_dot).high, 7.0f);
}

// 16-bit images with three hot pixels give the same as 8-bit images, to rounding: half a grey level of dots 153 levels
// high with slopes of 50 levels per pixel, over some hundred pixels of a patch, is below 0.01 px rms. Patches of 8 px
// at half and a quarter of the resolution include a hot pixel up to 32 px away.
TEST(InverseSearch, TakesGreyLevelsOfAnyDepth) {
  ParticlePair const pair = render_particle_pair({}, [](Vec2d) { return Vec2d{1.3, -0.4}; });
  ParticlePair deep = pair;
  for (Image<double>* frame : {&deep.reference, &deep.flow})
    for (double& level : *frame) level = 8.0 * level + 100.0;
  for (int k = 0; k < 3; ++k) deep.reference(40, 60 * k + 20) = 65535.0;
  DisplacementField const a = make_correlator(by_flow("dis"))->correlate(pair.reference, pair.flow);
  DisplacementField const b = make_correlator(by_flow("dis"))->correlate(deep.reference, deep.flow);
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    bool near = false;
    for (int k = 0; k < 3; ++k) near = near || length(a.position_px[i] - Vec2d{40.0, 60.0 * k + 20.0}) < 32.0;
    if (near) continue;
    Vec2d const apart = a.displacement_px[i] - b.displacement_px[i];
    squares += 0.5 * dot(apart, apart);
    count += 1.0;
  }
  EXPECT_LT(std::sqrt(squares / count), 0.01);
}

TEST(EveryOpticalFlow, IsOfSinglePairs) {
  ParticlePair const pair = render_particle_pair({}, [](Vec2d) { return Vec2d{}; });
  PairSequence const pairs{2, [&](std::size_t) { return HostFrames(pair.reference, pair.flow); }};
  for (char const* method : flows)
    EXPECT_THAT([&] { correlate_ensemble(pairs, by_flow(method)); },
                ThrowsDataError(ErrorCode::unsupported, "ensemble"));
}

}  // namespace
}  // namespace gladstone
