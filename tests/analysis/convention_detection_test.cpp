#include "analysis/vectors/convention_detection.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "analysis/vectors/convention_fit.h"
#include "analysis/vectors/convention_report.h"
#include "render/base/units.h"
#include "tests/support/numbers_in.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A field without symmetry, in which every axis, sign and half pixel has an effect: gradients of 0.05 px/px.
Vec2d asymmetric(Vec2d p) { return {1.0 + 0.05 * p.x - 0.03 * p.y, -0.5 + 0.05 * p.y + 0.01 * p.x}; }

/// Vectors of the field as a code with these conventions writes them, on a grid of 16 px that is not centred in the
/// image.
VectorFile written_by(VectorConventions const& c, int image_rows, double own_offset) {
  VectorFile file;
  file.format = "test";
  file.conventions.offset_px = own_offset;
  double const low = 15.5, high = 15.5 + 16.0 * 9;
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 12; ++column) {
      Vec2d const p{15.5 + 16.0 * column, 15.5 + 16.0 * row};
      Vec2d d = asymmetric(p);
      if (c.swapped) d = -d;
      if (c.v_up) d.y = -d.y;
      double const mirror = c.mirror == VectorConventions::Mirror::grid ? low + high : image_rows - 1.0;
      // apply_conventions first adds the offset and then mirrors; here in reverse order
      double const y = c.y_up ? mirror - p.y : p.y;
      file.field.position_px.push_back({p.x - c.offset_px, y - c.offset_px});
      file.field.displacement_px.push_back(d);
    }
  }
  return file;
}

TEST(DetectConventions, FindsEveryChoiceOfAxesSignsAndOffset) {
  int const image_rows = 200;
  for (bool const y_up : {false, true}) {
    for (bool const v_up : {false, true}) {
      for (bool const swapped : {false, true}) {
        for (double const offset : {0.0, -0.5, -1.0, -1.5}) {
          for (auto const mirror : {VectorConventions::Mirror::grid, VectorConventions::Mirror::image}) {
            if (!y_up && mirror == VectorConventions::Mirror::image) continue;
            VectorConventions const c{y_up, v_up, swapped, offset, mirror};
            DetectedConventions const found =
                detect_conventions(written_by(c, image_rows, 0.0), asymmetric, image_rows);
            EXPECT_EQ(found.conventions, VectorConventions{})
                << "the vectors are read by the conventions of the format";
            EXPECT_EQ(found.best.conventions, c) << describe(c) << " -> " << convention_report(found);
            EXPECT_EQ(found.mistake.found(), c != VectorConventions{})
                << describe(c) << " -> " << convention_report(found);
            EXPECT_FALSE(found.ambiguous) << convention_report(found);
            EXPECT_LT(found.best.rms_px, 1e-12);
          }
        }
      }
    }
  }
}

TEST(DetectConventions, GivesVectorsInOurOrder) {
  VectorConventions const c{true, true, false, -0.5, VectorConventions::Mirror::grid};
  VectorFile const file = written_by(c, 200, -0.5);
  DisplacementField const ours = apply_conventions(file.field, c, 200);
  ASSERT_EQ(ours.columns, 12);
  ASSERT_EQ(ours.rows, 10);
  EXPECT_EQ(ours.position_px.front(), (Vec2d{15.5, 15.5}));
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_NEAR(ours.displacement_px[i].x, asymmetric(ours.position_px[i]).x, 1e-12);
    EXPECT_NEAR(ours.displacement_px[i].y, asymmetric(ours.position_px[i]).y, 1e-12);
  }
}

// A uniform shift to the right is symmetric under a reflection in y: the conventions of the format are used and the
// ambiguity is reported.
TEST(DetectConventions, ReportsUndecidableConventions) {
  VectorFile file = written_by({}, 200, -0.5);
  for (Vec2d& d : file.field.displacement_px) d = {2.0, 0.0};
  DetectedConventions const found = detect_conventions(
      file,
      [](Vec2d) {
        return Vec2d{2.0, 0.0};
      },
      200);
  EXPECT_TRUE(found.ambiguous);
  EXPECT_EQ(found.conventions, file.conventions);
}

/// Waves without symmetry, with an amplitude of 0.1 px and wavelengths of 37 to 61 px. A shift by (12, -4) px is a
/// quarter of a period of both components, so that neither another sign nor an exchange of axes fits.
Vec2d waves(Vec2d p) {
  double const k = 2.0 * 3.14159265358979 / 37.0, q = 2.0 * 3.14159265358979 / 61.0;
  return {0.1 * std::sin(k * p.x + q * p.y), 0.1 * std::cos(q * p.x - 0.5 * k * p.y + 1.0)};
}

VectorFile waves_on_a_grid() {
  VectorFile file;
  file.format = "test";
  for (int row = 0; row < 20; ++row) {
    for (int column = 0; column < 24; ++column) {
      Vec2d const p{7.5 + 8.0 * column, 7.5 + 8.0 * row};
      file.field.position_px.push_back(p);
      file.field.displacement_px.push_back(waves(p));
    }
  }
  return file;
}

/// Two numbers in (-1, 1), the same in every run.
Vec2d noise(std::size_t i) {
  auto const one = [](double seed) {
    return 2.0 * (43758.5453 * std::abs(std::sin(seed)) - std::floor(43758.5453 * std::abs(std::sin(seed)))) - 1.0;
  };
  return {one(12.9898 * (static_cast<double>(i) + 1.0)), one(78.233 * (static_cast<double>(i) + 1.0))};
}

using Verdict = DetectedConventions::Verdict;

using Kind = MistakeReason::Kind;

/// Matches a reason: the frames were exchanged.
auto frames_exchanged(VectorFile const& file) {
  VectorConventions reading = file.conventions;
  reading.swapped = !reading.swapped;
  return testing::Truly([reading](MistakeReason const& one) { return same_axes(one.interpretation, reading); });
}

/// Matches a reason: y and v point in the opposite direction.
auto axes_reversed(VectorFile const& file) {
  VectorConventions reading = file.conventions;
  reading.y_up = !reading.y_up;
  reading.v_up = !reading.v_up;
  return testing::Truly([reading](MistakeReason const& one) { return same_axes(one.interpretation, reading); });
}

// The mistake in a file is reported, but the file is read as its format specifies. A shift by a quarter of a period, an
// exchange of columns and a factor cause differences of sqrt(2), sqrt(2) and 9 times the rms of the truth, and none
// after correction.
TEST(DetectConventions, ReportsProbableError) {
  struct Wrong {
    char const* mistake;
    void (*make)(Vec2d& place, Vec2d& displacement);
    char const* conventions;  ///< conventions that read it correctly; empty: none
    Kind kind = Kind::interpretation;
    Vec2d value{};
  };
  for (Wrong const &wrong : {
           Wrong{"v points up", [](Vec2d&, Vec2d&d) { d.y = -d.y; }, "y-down,v-up,offset=0"},
           Wrong{"u points left", [](Vec2d&, Vec2d&d) { d.x = -d.x; }, "y-down,v-up,frames-exchanged,offset=0"},
           Wrong{"the frames were exchanged", [](Vec2d&, Vec2d&d) { d = -d; },
                 "y-down,v-down,frames-exchanged,offset=0"},
           Wrong{"x and y are exchanged", [](Vec2d&p, Vec2d&) { std::swap(p.x, p.y); },
                 "y-down,v-down,places-exchanged,offset=0"},
           Wrong{"u and v are exchanged", [](Vec2d&, Vec2d&d) { std::swap(d.x, d.y); },
                 "y-down,v-down,components-exchanged,offset=0"},
           Wrong{"the axes are exchanged (x with y, u with v)",
                 [](Vec2d&p, Vec2d&d) {
                   std::swap(p.x, p.y);
                   std::swap(d.x, d.y);
                 },
                 "y-down,v-down,axes-exchanged,offset=0"},
           Wrong{"positions are shifted",
                 [](Vec2d&p, Vec2d&) {
                   p += Vec2d{12.0, -4.0};
                 },
                 "",
                 Kind::shift,
                 {12.0, -4.0}},
           Wrong{"displacements in another unit",
                 [](Vec2d&, Vec2d&d) { d = 0.01 * d; },
                 "y-down,v-down,offset=0,px/frame=0.01",
                 Kind::factor,
                 {0.01, 0.01}},
           Wrong{"displacements in a smaller unit",
                 [](Vec2d&, Vec2d&d) { d = 10.0 * d; },
                 "y-down,v-down,offset=0,px/frame=10",
                 Kind::factor,
                 {10.0, 10.0}},
           Wrong{"v points up, and displacements are in a smaller unit",
                 [](Vec2d&, Vec2d&d) {
                   d = {10.0 * d.x, -10.0 * d.y};
                 },
                 "y-down,v-up,offset=0,px/frame=10",
                 Kind::factor,
                 {10.0, 10.0}},
           Wrong{"positions in another unit",
                 [](Vec2d&p, Vec2d&) { p = 1.3 * p; },
                 "y-down,v-down,offset=0,px=1.3",
                 Kind::position_factor,
                 {1.3, 1.3}},
       }) {
    VectorFile file = waves_on_a_grid();
    for (std::size_t i = 0; i < file.field.size(); ++i)
      wrong.make(file.field.position_px[i], file.field.displacement_px[i]);
    DetectedConventions const found = detect_conventions(file, waves, 200);
    EXPECT_EQ(found.verdict, Verdict::mistaken) << wrong.mistake << ": " << convention_report(found);
    EXPECT_EQ(found.mistake.conventions, wrong.conventions) << wrong.mistake;
    ASSERT_EQ(found.mistake.reasons.size(), 1u) << wrong.mistake;
    MistakeReason const& reason = found.mistake.reasons[0];
    EXPECT_EQ(reason.kind, wrong.kind) << wrong.mistake;
    EXPECT_LT(length(reason.value - wrong.value), wrong.kind == Kind::shift ? 0.01 : 0.005 * length(wrong.value) + 1e-9)
        << wrong.mistake;
    // The description gives shifts to 0.01 px.
    EXPECT_LT(length(found.mistake.correction.shift_px + (wrong.kind == Kind::shift ? wrong.value : Vec2d{})), 0.01)
        << wrong.mistake;
    EXPECT_EQ(found.conventions, file.conventions) << "the file is read by the conventions of its format";
    // The vectors have no noise. Shifts are known to 0.1 px, which along a wave of 37 px is 2 pi 0.1 / 37 = 1.7 % of
    // the amplitude; factors are stored to three digits, 0.5 %.
    EXPECT_LT(found.mistake.corrected_fit.rms_px, 0.02 * found.mistake.as_read.rms_px) << wrong.mistake;
    EXPECT_EQ(found.tried.size(), 32u) << "2 directions of y, 2 of v, 2 orders of the frames, 4 exchanges of columns";
    EXPECT_THAT(convention_report(found), HasSubstr(describe_mistake(found.mistake)));
  }
}

// Windows as long as a wave reduce it to a quarter of the truth; for a uniform displacement only another unit has this
// effect.
TEST(DetectConventions, DistinguishesScaleFromWindowAveraging) {
  VectorFile file = waves_on_a_grid();
  for (Vec2d& d : file.field.displacement_px) d = 0.25 * d;
  EXPECT_EQ(detect_conventions(file, waves, 200).verdict, Verdict::fits);
  auto const slow = [](Vec2d p) { return Vec2d{1.0 + 0.002 * p.x, 0.7 - 0.001 * p.y}; };
  for (std::size_t i = 0; i < file.field.size(); ++i)
    file.field.displacement_px[i] = 0.25 * slow(file.field.position_px[i]);
  ProbableMistake const mistake = detect_conventions(file, slow, 200).mistake;
  EXPECT_EQ(mistake.correction.factor, (Vec2d{0.25, 0.25})) << "median of ratios that are exact in binary";
  EXPECT_THAT(numbers_in(describe_mistake(mistake)), testing::ElementsAre(0.25));
}

// A rotation about the middle is symmetric under an exchange of the frames with a reflection of both axes: both
// readings are reported.
TEST(DetectConventions, ReportsAllIndistinguishableErrors) {
  VectorFile file;
  file.format = "test";
  auto const vortex = [](Vec2d p) { return Vec2d{0.02 * (p.y - 99.5), -0.02 * (p.x - 99.5)}; };
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 12; ++column) {
      Vec2d const p{11.5 + 16.0 * column, 11.5 + 16.0 * row};
      file.field.position_px.push_back(p);
      file.field.displacement_px.push_back(-vortex(p));
    }
  }
  DetectedConventions const found = detect_conventions(file, vortex, 200);
  ASSERT_FALSE(found.mistake.reasons.empty());
  EXPECT_THAT(found.mistake.reasons.front(), frames_exchanged(file));
  EXPECT_THAT(found.mistake.reasons, testing::Contains(axes_reversed(file)));
  // Vectors of the opposite sign differ by twice the truth. In the corners that exceeds the limit of three times the
  // signal (ConventionFit), which leaves 1.95 times the signal if the components are limited and 1.99 if the vectors
  // are.
  EXPECT_GT(found.fit.rms_px, 1.9 * found.fit.signal_px);
}

// The errors of the readings differ by 2 %, as for an estimator with a bias to the right: the most likely mistake is
// still reported first, and a shift is not reported as an exchange of axes, although an exchange
// reduces its effect.
TEST(DetectConventions, ReportsMostProbableOfSimilarFits) {
  VectorFile file;
  file.format = "test";
  auto const vortex = [](Vec2d p) {
    Vec2d const r{p.x - 99.5, p.y - 99.5};
    double const swirl = 4.0 * std::exp(-dot(r, r) / 3600.0) / 60.0;
    return Vec2d{-swirl * r.y, swirl * r.x};
  };
  for (int row = 0; row < 23; ++row) {
    for (int column = 0; column < 23; ++column) {
      Vec2d const p{11.5 + 8.0 * column, 11.5 + 8.0 * row};
      file.field.position_px.push_back(p);
      file.field.displacement_px.push_back(vortex(p) + Vec2d{0.01 + 0.03 * noise(file.field.size()).x, 0.004});
    }
  }
  VectorFile exchanged = file;
  for (Vec2d& d : exchanged.field.displacement_px) d = -d;
  std::vector<MistakeReason> const reasons = detect_conventions(exchanged, vortex, 200).mistake.reasons;
  ASSERT_FALSE(reasons.empty());
  EXPECT_THAT(reasons.front(), frames_exchanged(file));
  EXPECT_THAT(reasons, testing::Contains(axes_reversed(file)));
  VectorFile shifted = file;
  for (Vec2d& p : shifted.field.position_px) p.x += 16.0;
  ProbableMistake const shift = detect_conventions(shifted, vortex, 200).mistake;
  EXPECT_EQ(shift.reasons.front().kind, Kind::shift);
  // three standard errors, which the description gives, are 0.17 px; it rounds the shift to 0.1 px
  EXPECT_NEAR(shift.correction.shift_px.x, -16.0, 0.17);
  EXPECT_NEAR(numbers_in(describe_mistake(shift)).at(0), -shift.correction.shift_px.x, 0.05);
  EXPECT_FALSE(detect_conventions(file, vortex, 200).mistake.found());
}

// A shift of the positions is reported with its resolution: three standard errors, for windows that overlap by half.
// Noise that is independent from vector to vector is averaged better than that, so that all 20 results are within the
// resolution.
TEST(DetectConventions, ShiftIsKnownToItsResolution) {
  auto const vortex = [](Vec2d p) {
    Vec2d const r{p.x - 99.5, p.y - 99.5};
    double const swirl = 4.0 * std::exp(-dot(r, r) / 3600.0) / 60.0;
    return Vec2d{-swirl * r.y, swirl * r.x};
  };
  for (double const sigma_px : {0.0, 0.01, 0.03}) {
    for (int seed = 0; seed < 20; ++seed) {
      std::mt19937 random(static_cast<unsigned>(seed));
      std::normal_distribution<double> noise(0.0, 1.0);
      VectorFile file;
      file.format = "test";
      Vec2d const shift{5.3 + 0.31 * seed, -2.7 - 0.07 * seed};
      for (int node = 0; node < 23 * 23; ++node) {
        Vec2d const p{11.5 + 8.0 * (node % 23), 11.5 + 8.0 * (node / 23)};
        Vec2d const error{noise(random), noise(random)};
        file.field.position_px.push_back(p + shift);
        file.field.displacement_px.push_back(vortex(p) + sigma_px * error);
      }
      std::string const text = describe_mistake(detect_conventions(file, vortex, 200).mistake);
      auto const values = numbers_in(text);
      ASSERT_EQ(values.size(), 3u) << text;
      Vec2d const found{values[0], values[1]};
      double const known_px = values[2];
      EXPECT_LE(std::abs(found.x - shift.x), known_px) << text << ' ' << seed;
      EXPECT_LE(std::abs(found.y - shift.y), known_px) << text << ' ' << seed;
      EXPECT_LE(known_px, sigma_px == 0.0 ? 0.01 : 1.0) << text;
    }
  }
}

// Zero displacement, noise, and positions in mm (all within 16 px) follow the truth in no reading.
TEST(DetectConventions, RejectsVectorsThatFitNoConvention) {
  for (auto const make : {+[](Vec2d&, Vec2d&d, Vec2d) { d = {}; }, +[](Vec2d&, Vec2d&d, Vec2d n) { d = 0.1 * n; },
                          +[](Vec2d&p, Vec2d&, Vec2d) { p = 0.085 * p; }}) {
    VectorFile file = waves_on_a_grid();
    for (std::size_t i = 0; i < file.field.size(); ++i)
      make(file.field.position_px[i], file.field.displacement_px[i], noise(i));
    DetectedConventions const found = detect_conventions(file, waves, 200);
    EXPECT_EQ(found.verdict, Verdict::no_convention_fits) << convention_report(found);
    EXPECT_THAT(convention_report(found), AllOf(HasSubstr("v-up,frames-exchanged"),
                                                HasSubstr(fmt::format("{:.3g} px", found.tried.front().signal_px))));
  }
}

// A shear determines only a shift across its layers, and a uniform stretch of u only a factor of u.
TEST(DetectConventions, ReportsOnlyDeterminableConventions) {
  auto const shear = [](Vec2d p) { return Vec2d{2.0 * std::sin(p.y / 20.0), 0.0}; };
  VectorFile shifted = waves_on_a_grid(), stretched = shifted;
  for (std::size_t i = 0; i < shifted.field.size(); ++i) {
    Vec2d const p = shifted.field.position_px[i];
    shifted.field.displacement_px[i] = shear(p - Vec2d{16.0, 16.0}) + 0.02 * noise(i);
    stretched.field.displacement_px[i] = 3.0 * shear(p) + 0.02 * noise(i);
  }
  ProbableMistake const shift = detect_conventions(shifted, shear, 200).mistake;
  ASSERT_EQ(shift.reasons.size(), 1u);
  EXPECT_FALSE(shift.reasons[0].uncertainty.x < max_shift_uncertainty_px);
  EXPECT_LT(shift.reasons[0].uncertainty.y, max_shift_uncertainty_px);
  auto const values = numbers_in(describe_mistake(shift));
  ASSERT_EQ(values.size(), 2u) << "the shift in y and its resolution, but none in x: " << describe_mistake(shift);
  EXPECT_EQ(values[0], 15.99);
  ProbableMistake const stretch = detect_conventions(stretched, shear, 200).mistake;
  ASSERT_EQ(stretch.reasons.size(), 1u);
  EXPECT_EQ(stretch.reasons[0].kind, Kind::factor);
  EXPECT_NEAR(stretch.reasons[0].value.x, 3.0, 0.005) << "the description has three digits";
  EXPECT_TRUE(std::isnan(stretch.reasons[0].value.y)) << "v does not determine a factor";
  EXPECT_THAT(numbers_in(describe_mistake(stretch)), testing::ElementsAre(3));
  EXPECT_NEAR(stretch.correction.factor.x, 3.0, 0.005) << "the description has three digits";
}

// A bias of u is not reported as a shift of positions by a pixel, which would change the many small errors of v but
// hardly the bias.
TEST(DetectConventions, BiasOfOneComponentIsNoShift) {
  VectorFile file = waves_on_a_grid();
  for (std::size_t i = 0; i < file.field.size(); ++i)
    file.field.displacement_px[i] += Vec2d{0.1, 0.0} + 0.01 * noise(i);
  EXPECT_FALSE(detect_conventions(file, waves, 200).mistake.found());
}

// Vectors that are all 0 are not reported as an offset of a uniform displacement.
TEST(DetectConventions, NamesVectorsThatAreAllZero) {
  VectorFile file = waves_on_a_grid();
  for (Vec2d& d : file.field.displacement_px) d = {};
  DetectedConventions const found = detect_conventions(
      file,
      [](Vec2d) {
        return Vec2d{3.2, 0.0};
      },
      200);
  EXPECT_EQ(found.verdict, Verdict::no_convention_fits);
  EXPECT_TRUE(found.all_zero);
  EXPECT_FALSE(found.mistake.found()) << describe_mistake(found.mistake);
}

// Windows of 64 px do not resolve a sine of 32 px: such vectors are noise, not a mistake in the file.
TEST(DetectConventions, IgnoresWavesThatWindowsCannotResolve) {
  auto const sine = [](Vec2d p) { return Vec2d{2.0 * std::sin(2.0 * 3.14159265358979 * p.y / 32.0), 0.0}; };
  VectorFile file = waves_on_a_grid();
  for (std::size_t i = 0; i < file.field.size(); ++i) file.field.displacement_px[i] = 0.1 * noise(i);
  DetectedConventions const found = detect_conventions(file, sine, 200);
  EXPECT_EQ(found.verdict, Verdict::cannot_be_told) << convention_report(found);
}

// With few vectors the best of sixty choices is closer to the truth by chance than zero displacement. Twenty vectors of
// the shifted field, or of noise, must fit no reading; twenty correct ones must fit.
TEST(DetectConventions, DoesNotMistakeRandomVectorsForFit) {
  VectorFile file = waves_on_a_grid();
  std::vector<std::size_t> few;
  for (std::size_t i = 0; i < 460; i += 23) few.push_back(i);
  take_vectors(file.field, few);
  EXPECT_EQ(detect_conventions(file, waves, 200).verdict, Verdict::fits);
  for (std::size_t trial = 0; trial < 20; ++trial) {
    for (std::size_t i = 0; i < few.size(); ++i) {
      file.field.displacement_px[i] = 0.1 * noise(few.size() * trial + i);
    }
    EXPECT_NE(detect_conventions(file, waves, 200).verdict, Verdict::fits) << trial;
  }
}

// 480 vectors with noise of three times the signal: the slope is 1 with two standard errors of 2 * 3 / sqrt(960) = 0.2.
TEST(DetectConventions, AcceptsNoisyVectorsThatFollowTruth) {
  VectorFile file = waves_on_a_grid();
  double const three_times = 3.0 * std::sqrt(3.0) * 0.1 / std::sqrt(2.0);  // of numbers uniform in (-1, 1)
  for (std::size_t i = 0; i < file.field.size(); ++i) file.field.displacement_px[i] += three_times * noise(i);
  DetectedConventions const found = detect_conventions(file, waves, 200);
  EXPECT_EQ(found.verdict, Verdict::noisy) << convention_report(found);
  EXPECT_FALSE(found.conventions.y_up);
  EXPECT_FALSE(found.conventions.v_up);
  for (std::size_t i = 0; i < file.field.size(); ++i) file.field.displacement_px[i] = three_times * noise(i);
  EXPECT_EQ(detect_conventions(file, waves, 200).verdict, Verdict::no_convention_fits) << "noise alone";
}

// Without displacement, or with a displacement below the resolution of a correlation, every choice fits equally well:
// the conventions of the format are used.
TEST(DetectConventions, IsUndecidedIfSignalIsBelowNoise) {
  for (double const signal : {0.0, 0.05}) {
    VectorFile file = waves_on_a_grid();
    file.conventions.offset_px = -0.5;
    auto const truth = [signal](Vec2d p) { return signal * waves(p); };
    for (std::size_t i = 0; i < file.field.size(); ++i) {
      file.field.displacement_px[i] = truth(file.field.position_px[i]) + 0.05 * noise(i);
    }
    DetectedConventions const found = detect_conventions(file, truth, 200);
    EXPECT_EQ(found.verdict, Verdict::cannot_be_told) << convention_report(found);
    EXPECT_EQ(found.conventions, file.conventions);
  }
}

// A small signal with small errors is sufficient.
TEST(DetectConventions, DecidesOnSmallAccurateSignals) {
  VectorFile file = waves_on_a_grid();
  auto const truth = [](Vec2d p) { return 0.05 * waves(p); };
  for (std::size_t i = 0; i < file.field.size(); ++i) {
    Vec2d const d = truth(file.field.position_px[i]) + 0.002 * noise(i);
    file.field.displacement_px[i] = {d.x, -d.y};
  }
  DetectedConventions const found = detect_conventions(file, truth, 200);
  EXPECT_EQ(found.verdict, Verdict::mistaken) << convention_report(found);
  EXPECT_EQ(found.mistake.conventions, "y-down,v-up,offset=0");
  EXPECT_TRUE(found.best.conventions.v_up);
}

// Half a pixel in waves of slope 2 pi 0.1 px / 37 px causes a difference of up to 0.0085 px, and none with the correct
// offset.
TEST(DetectConventions, ReportsTheOffsetWithAndWithout) {
  VectorFile file = waves_on_a_grid();
  for (Vec2d& p : file.field.position_px) p += Vec2d{0.5, 0.5};
  DetectedConventions const found = detect_conventions(file, waves, 200);
  EXPECT_EQ(found.best.conventions.offset_px, -0.5);
  EXPECT_LT(found.best.rms_px, 1e-12);
  EXPECT_GT(found.fit.rms_px, 0.003);
  EXPECT_EQ(found.mistake.conventions, "y-down,v-down,offset=-0.5");
  EXPECT_THAT(numbers_in(describe_mistake(found.mistake)), testing::ElementsAre(0.5));

  VectorFile half = file;
  half.conventions.offset_px = -0.5;
  DetectedConventions const right = detect_conventions(half, waves, 200);
  EXPECT_FALSE(right.mistake.found()) << convention_report(right);
  EXPECT_LT(right.fit.rms_px, 1e-12);
  EXPECT_GT(right.without_offset.rms_px, 0.003);
  EXPECT_THAT(convention_report(right), AllOf(HasSubstr("x - 0.5 px"), HasSubstr("0.00")));

  VectorFile own = waves_on_a_grid();
  own.conventions.offset_px = -0.5;  // as its format specifies; the numbers do not determine it
  own.field.displacement_px.assign(own.field.size(), Vec2d{1.0, 0.5});
  auto const uniform = [](Vec2d) { return Vec2d{1.0, 0.5}; };
  DetectedConventions const undecided = detect_conventions(own, uniform, 200);
  EXPECT_EQ(undecided.fit.rms_px, undecided.without_offset.rms_px);
  EXPECT_THAT(offset_report(undecided), HasSubstr("x - 0.5 px"));
  EXPECT_THAT(offset_report(detect_conventions(waves_on_a_grid(), waves, 200)), testing::IsEmpty());
}

/// Waves with errors of 0.02 px on a grid with correct positions, although the conventions of the format include x -
/// 0.5 px.
VectorFile noisy_waves(double moved, double offset) {
  VectorFile file = waves_on_a_grid();
  std::mt19937_64 bits(3);
  std::normal_distribution<double> error(0.0, 0.02);
  for (std::size_t i = 0; i < file.field.size(); ++i) {
    file.field.position_px[i] += Vec2d{moved, moved};
    file.field.displacement_px[i] += Vec2d{error(bits), error(bits)};
  }
  file.conventions.offset_px = offset;
  file.also = {VectorConventions{}};  // as for several passes of the same code
  return file;
}

// Half a pixel in waves of slope 0.017 is 0.006 px rms, 0.3 times the errors: their rms grows by 4 %, which a thousand
// vectors distinguish from chance, both for codes whose multi-pass vectors are at the grid positions and for those
// whose vectors are not.
TEST(DetectConventions, DetectsHalfPixelOffsetInNoise) {
  DetectedConventions const deformed = detect_conventions(noisy_waves(0.0, -0.5), waves, 200);
  EXPECT_EQ(deformed.conventions.offset_px, 0.0) << convention_report(deformed);
  DetectedConventions const plain = detect_conventions(noisy_waves(0.5, -0.5), waves, 200);
  EXPECT_EQ(plain.conventions.offset_px, -0.5) << convention_report(plain);
}

// One vector in a hundred is wrong by 50 px: it counts as 1 px, and the axes are detected as before.
TEST(DetectConventions, IsRobustAgainstOutliers) {
  VectorFile file = waves_on_a_grid();
  for (std::size_t i = 0; i < file.field.size(); i += 100) file.field.displacement_px[i] = {50.0, -50.0};
  DetectedConventions const found = detect_conventions(file, waves, 200);
  EXPECT_NE(found.verdict, Verdict::no_convention_fits) << convention_report(found);
  EXPECT_EQ(found.conventions, VectorConventions{});
}

/// The waves as a program writes them: "x y u v" at the nodes of the grid, y and v upwards from the last of 200 rows or
/// both downwards, with another position of the first pixel's centre than 0.
std::string written_waves(bool upwards, double first_pixel, char separator, std::string const& rest_of_row) {
  VectorFile const grid = waves_on_a_grid();
  std::ostringstream text;
  text.precision(12);
  for (std::size_t i = 0; i < grid.field.size(); ++i) {
    Vec2d const p = grid.field.position_px[i], d = grid.field.displacement_px[i];
    text << p.x + first_pixel << separator << (upwards ? 199.0 - p.y : p.y) + first_pixel << separator << d.x
         << separator << (upwards ? -d.y : d.y) << rest_of_row << '\n';
  }
  return text.str();
}

// Programs count pixels from 0 or 1, and from the centre or the edge of the first pixel. Each file is read with the
// axes of its format; the offset that fits is selected, and the positions are then those of the grid.
TEST(DetectConventions, FindsWhereEachFormatCountsFrom) {
  using Mirror = VectorConventions::Mirror;
  struct Format {
    char const *program, *ending, *header;
    char separator;
    char const* rest_of_row;
    bool upwards;
    std::vector<double> first_pixels;  ///< coordinate of the first pixel's centre, in the order of preference
  };
  std::vector<double> const any{0, 0.5, 1, 1.5};
  std::string const folder = testing::TempDir();
  for (Format const& format :
       {Format{"JPIV", ".jvc", "", ' ', " 1.0", false, any},
        Format{"Dantec", ".csv", ">>*HEADER*<<\nGridSize:{Width=24, Height=20}\n>>*DATA*<<\nx,y,U pix,V pix,Status\n",
               ',', ",0", true, any},
        Format{"DaVis", ".dat", "TITLE = \"b\"\nVARIABLES = \"x\", \"y\", \"Vx\", \"Vy\"\nZONE I=24, J=20, F=POINT\n",
               ' ', "", true, any},
        Format{"Insight", ".vec",
               "TITLE=\"b\" VARIABLES=\"X pixel\", \"Y pixel\", \"U pixel\", \"V pixel\", \"CHC\", ZONE I=24, J=20\n",
               ',', ",1", true, any},
        Format{"Tecplot", ".plt", "VARIABLES = x, y, u, v\nZONE I=24, J=20, F=POINT\n", ' ', "", true, any},
        Format{"PIVlab",
               ".txt",
               "PIVlab, ASCII chart output\nFRAME: 1\nx [px],y [px],u [px/frame],v [px/frame],Vector type [-]\n",
               ',',
               ",1",
               false,
               {1.5, 1, 0.5, 0}},
        Format{"OpenPIV", ".txt", "# x\ty\tu\tv\tflags\tmask\n", '\t', "\t0\t0", false, {0.5, 0}}}) {
    for (double const first_pixel : format.first_pixels) {
      std::string const path = folder + "/gladstone_counted_from_" + format.program + format.ending;
      std::ofstream(path) << format.header
                          << written_waves(format.upwards, first_pixel, format.separator, format.rest_of_row);
      VectorFile const file = read_vectors(path);
      std::remove(path.c_str());
      ASSERT_EQ(file.format, format.program);
      EXPECT_EQ(file.conventions.y_up, format.upwards) << format.program;
      EXPECT_EQ(file.conventions.v_up, format.upwards) << format.program;
      EXPECT_EQ(file.conventions.mirror, format.upwards ? Mirror::image : Mirror::grid) << format.program;
      EXPECT_EQ(file.conventions.offset_px, -format.first_pixels.front()) << format.program;
      DetectedConventions const found = detect_conventions(file, waves, 200);
      EXPECT_EQ(found.verdict, Verdict::fits) << format.program << first_pixel << convention_report(found);
      VectorConventions expected = file.conventions;
      expected.offset_px = -first_pixel;
      EXPECT_EQ(found.conventions, expected) << format.program << first_pixel << convention_report(found);
      DisplacementField const ours = apply_conventions(file.field, found.conventions, 200);
      VectorFile const grid = waves_on_a_grid();
      ASSERT_EQ(ours.size(), grid.field.size());
      for (std::size_t i = 0; i < ours.size(); ++i) {
        EXPECT_LT(length(ours.position_px[i] - grid.field.position_px[i]), 1e-9) << format.program << first_pixel;
        EXPECT_LT(length(ours.displacement_px[i] - grid.field.displacement_px[i]), 1e-9) << format.program;
      }
    }
  }
}

// Files of OpenPIV 0.26.1 (extended_search_area_piv of 32 px; windef with 64, 32, 16 px) for render_particle_pair() of
// 160 x 160 px, 1 % noise, seed 77 and this displacement. Both write x = ws/2. The single pass measures half a pixel
// away from that position; windef deforms the images at exactly these positions, to which its vectors therefore belong.
// Only the file name and the displacement distinguish the two.
TEST(DetectConventions, DistinguishesOpenPivPassTypes) {
  auto const flow = [](Vec2d p) { return Vec2d{1.5 + std::sin(2.0 * pi * p.y / 160.0), 0.02 * (p.x - 79.5)}; };
  std::string const folder = std::string(GLADSTONE_DATA_DIR) + "/../tests/fuzz/corpus/vector_text/openpiv_0.26_";
  for (auto const& [name, offset] : {std::pair{"windef", 0.0}, {"one_pass", -0.5}}) {
    VectorFile const file = read_vectors(folder + name + ".txt");
    EXPECT_EQ(file.format, "OpenPIV");
    DetectedConventions const found = detect_conventions(file, flow, 160);
    EXPECT_EQ(found.verdict, Verdict::fits) << convention_report(found);
    EXPECT_EQ(describe(found.conventions), std::string("y-up,v-up,offset=") + (offset == 0.0 ? "0" : "-0.5"))
        << convention_report(found);
  }
}

}  // namespace
}  // namespace gladstone
