#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/standard_correlator.h"
#include "studies/benchmark/particle_pair.h"

namespace gladstone {
namespace {

/// A symmetry operation: its effect on an image, on a vector, and on a position.
struct Symmetry {
  char const* name;
  bool mirrors_x, mirrors_y, transposes;

  Image<double> of(Image<double> const& image) const {
    int const columns = image.columns(), rows = image.rows();
    Image<double> result(transposes ? rows : columns, transposes ? columns : rows);
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        int const x = mirrors_x ? columns - 1 - i : i, y = mirrors_y ? rows - 1 - j : j;
        (transposes ? result(y, x) : result(x, y)) = image(i, j);
      }
    return result;
  }
  Vec2d of(Vec2d d) const {
    Vec2d const turned{mirrors_x ? -d.x : d.x, mirrors_y ? -d.y : d.y};
    return transposes ? Vec2d{turned.y, turned.x} : turned;
  }
  /// Index that vector i of a grid has in the transformed grid.
  std::size_t of(std::size_t i, DisplacementField const& field) const {
    std::size_t const columns = static_cast<std::size_t>(field.columns), rows = static_cast<std::size_t>(field.rows);
    std::size_t const x = i % columns, y = i / columns;
    std::size_t const to_x = mirrors_x ? columns - 1 - x : x, to_y = mirrors_y ? rows - 1 - y : y;
    return transposes ? to_x * rows + to_y : to_y * columns + to_x;
  }
};

constexpr Symmetry symmetries[] = {{"mirrored from left to right", true, false, false},
                                   {"mirrored from top to bottom", false, true, false},
                                   {"turned by half a turn", true, true, false},
                                   {"transposed", false, false, true},
                                   {"turned by a quarter", true, false, true}};

struct Difference {
  double largest = 0;  ///< [px]
  std::size_t statuses = 0;
};

/// Differences between the vectors of transformed frames and the transformed vectors.
Difference difference(CorrelationSettings const& settings, ParticlePair const& pair, Symmetry const& symmetry) {
  auto const correlator = make_correlator(settings);
  DisplacementField const plain = correlator->correlate(pair.reference, pair.flow);
  DisplacementField const changed = correlator->correlate(symmetry.of(pair.reference), symmetry.of(pair.flow));
  Difference result;
  EXPECT_EQ(plain.size(), changed.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    std::size_t const k = symmetry.of(i, plain);
    result.statuses += plain.status[i] != changed.status[k] || plain.ambiguous[i] != changed.ambiguous[k];
    if (!plain.counts(i) || !changed.counts(k)) continue;
    result.largest =
        std::max(result.largest, length(symmetry.of(plain.displacement_px[i]) - changed.displacement_px[k]));
  }
  return result;
}

/// A vortex with a shear, up to 6 px, without any symmetry.
Vec2d flow_at(Vec2d p) {
  Vec2d const r{p.x - 100.0, p.y - 150.0};
  double const turn = 4.0 * std::exp(-dot(r, r) / 5000.0) / 70.0;
  return {2.3 - turn * r.y + 0.004 * p.y, -1.1 + turn * r.x};
}

// Windows of mirrored or transposed frames contain the mirrored or transposed pixels if the last grid fits the frames
// on both sides and the earlier passes are centred on it. Only the order of sums in single precision differs:
// transforms of 48^2 values round to 6e-8 log2(48^2) = 7e-7 of the largest value of the plane. A peak of height c and
// variance s^2 (1.1 px^2 for dots of 3 px) moves by that times s^2 / c: 1e-6 px, and 2e-5 px at c = 0.05 in noise.
// Later passes correct errors of their predictor and do not add to them; twice that is allowed.
constexpr double rounding_px = 5e-5;

TEST(Symmetry, DefaultPassesMeasureMirroredAndTurnedFramesAlike) {
  for (double const noise : {0.0, 0.05}) {
    // 20 + 8 k px: the last windows, 8 px apart, end at the right edge as they begin at the left edge
    ParticlePair const pair = render_particle_pair({.columns = 260, .rows = 292, .noise = noise}, flow_at);
    for (Symmetry const& symmetry : symmetries) {
      Difference const found = difference({}, pair, symmetry);
      EXPECT_LT(found.largest, rounding_px) << symmetry.name << ", noise " << noise;
      EXPECT_EQ(found.statuses, 0u) << symmetry.name << ", noise " << noise;
    }
  }
}

// Frames of odd size, whose middle is a pixel, with coarse spacings of either parity (29, 14, 11 px; the last 9 px).
TEST(Symmetry, HoldsForFramesOfOddSides) {
  CorrelationSettings settings;
  settings.overlap = 0.55;
  ParticlePair const pair = render_particle_pair({.columns = 263, .rows = 281, .noise = 0.02}, flow_at);
  for (Symmetry const& symmetry : symmetries) {
    Difference const found = difference(settings, pair, symmetry);
    EXPECT_LT(found.largest, rounding_px) << symmetry.name;
    EXPECT_EQ(found.statuses, 0u) << symmetry.name;
  }
}

TEST(Symmetry, HoldsForPassesOfAPivPairAndMorePassesOfTheLastWindow) {
  ParticlePair const pair = render_particle_pair({.columns = 264, .rows = 312, .noise = 0.02}, flow_at);
  CorrelationSettings settings;
  settings.window_px = {32, 24};
  settings.overlap = 0.5;
  settings.final_passes = 3;
  for (Symmetry const& symmetry : symmetries)
    EXPECT_LT(difference(settings, pair, symmetry).largest, rounding_px) << symmetry.name;
}

// A grid is symmetric: as many pixels before its first window as behind its last one, all windows inside, and no space
// for another window. A single window cannot always be centred on whole pixels.
TEST(CentredGrid, HasEqualMarginsOnBothSides) {
  for (int const window : {8, 16, 20, 24, 32, 64})
    for (double const overlap : {0.0, 0.3, 0.5, 0.6, 0.75, 0.9})
      for (int columns = window; columns < 4 * window; ++columns)
        for (int const rows : {2 * window, 3 * window + 1, 5 * window + 7}) {
          InterrogationGrid const grid = make_centred_grid(columns, rows, window, overlap);
          InterrogationGrid const plain = make_interrogation_grid(columns, rows, window, overlap);
          EXPECT_LE(grid.spacing_px, plain.spacing_px);
          EXPECT_GE(grid.spacing_px, plain.spacing_px - 1);
          for (GridAxis const axis : {GridAxis::x, GridAxis::y}) {
            int const length = axis == GridAxis::x ? columns : rows, windows = grid.windows(axis);
            int const before = grid.first_px(axis), behind = length - before - window - (windows - 1) * grid.spacing_px;
            ASSERT_GE(windows, 1);
            EXPECT_GE(before, 0);
            EXPECT_LE(std::abs(behind - before), windows == 1 ? 1 : 0) << window << ' ' << overlap << ' ' << length;
            EXPECT_LT(before, grid.spacing_px);
          }
        }
  EXPECT_EQ(make_centred_grid(15, 64, 16, 0.5).size(), 0u);
}

TEST(CentredGrid, NamesBothWindowsThatAreEquallyNear) {
  InterrogationGrid const grid = make_centred_grid(64, 48, 16, 0.5);  // centres 7.5, 15.5, ... 55.5
  auto const nearest = [&](double x) { return grid.nearest(GridAxis::x, x); };
  EXPECT_EQ(nearest(15.5).first, 1);
  EXPECT_EQ(nearest(15.5).last, 1);
  EXPECT_EQ(nearest(19.5).first, 1);
  EXPECT_EQ(nearest(19.5).last, 2);
  EXPECT_EQ(nearest(-9.0).last, 0);
  EXPECT_EQ(nearest(99.0).first, 6);
}

// Exchanged frames give the negative vectors: in one pass and over the default passes to single precision as above
// (zncc and mqd divide by planes of energies with the same relative error), and with half the difference of two flows
// exactly.
TEST(EveryMethod, GivesTheNegativeVectorsOfExchangedFrames) {
  ParticlePair const pair = render_particle_pair({.columns = 260, .rows = 260, .noise = 0.02}, flow_at);
  for (std::string const method : {"scc", "rpc", "spc", "zncc", "mqd", "opencv", "dis", "horn_schunck"})
    for (bool const one_pass : {true, false}) {
      CorrelationSettings settings;
      settings.method = method;
      if (one_pass) settings.window_px = {32};
      auto const correlator = make_correlator(settings);
      DisplacementField const forward = correlator->correlate(pair.reference, pair.flow);
      DisplacementField const backward = correlator->correlate(pair.flow, pair.reference);
      double largest = 0;
      for (std::size_t i = 0; i < forward.size(); ++i)
        if (forward.counts(i) && backward.counts(i))
          largest = std::max(largest, length(forward.displacement_px[i] + backward.displacement_px[i]));
      double const bound = method == "dis" ? 0.0 : method == "zncc" || method == "mqd" ? 5e-5 : rounding_px;
      EXPECT_LE(largest, bound) << method << (one_pass ? ", one pass" : ", default passes");
    }
}

}  // namespace
}  // namespace gladstone
