#include "analysis/uncertainty/window_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "analysis/correlation/correlator.h"
#include "analysis/correlation/standard_correlator.h"
#include "analysis/correlation/vector_validation.h"
#include "analysis/uncertainty/eight_columns.h"
#include "analysis/uncertainty/matched_windows.h"
#include "analysis/uncertainty/neighbour_mean.h"
#include "analysis/uncertainty/pass_amplification.h"
#include "studies/benchmark/particle_pair.h"

namespace gladstone {
namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// Pixels of a window; rows are padded to whole vectors with pixels of zero weight.
struct PlainWindow {
  explicit PlainWindow(int of) : side(of), pitch((of + lane_count - 1) / lane_count * lane_count) {
    for (std::vector<float>* image : {&weight, &reference, &flow})
      image->resize(static_cast<std::size_t>(side) * pitch);
  }
  std::size_t at(int x, int row) const { return static_cast<std::size_t>(row) * pitch + x; }

  int side, pitch;
  std::vector<float> weight, reference, flow;
};

template <class Columns>
struct PlainPixels {
  PlainWindow const& window;
  MatchedPixels<typename Columns::Value> at(int x, int row) const {
    std::size_t const k = window.at(x, row);
    return {Columns::load(&window.weight[k]), Columns::load(&window.reference[k]), Columns::load(&window.flow[k])};
  }
};

/// The threads of a block, one after the other, in ascending or descending order: if threads exchanged values without a
/// barrier, the two orders would give different results.
template <class Columns>
StatisticsSums sums_by_threads(PlainWindow const& window, int threads, bool falling) {
  using Window = WindowStatistics<Columns>;
  std::vector<float> memory(static_cast<std::size_t>(Window::values(window.side)),
                            std::numeric_limits<float>::quiet_NaN());
  PlainPixels<Columns> const pixels{window};
  auto const threads_do = [&](auto const& step) {
    for (int k = 0; k < threads; ++k) {
      int const thread = falling ? threads - 1 - k : k;
      step(Window{memory.data(), window.side, thread, threads}, static_cast<std::size_t>(thread));
    }
  };
  std::vector<WindowSums<double>> light(static_cast<std::size_t>(threads));
  std::vector<Vec2d> square_shares(light.size());
  std::vector<StatisticsSums> shares(light.size());
  threads_do([&](Window const& own, std::size_t thread) {
    own.clear();
    light[thread] = own.sum_pixels(pixels);
  });
  WindowSums<double> all_light;
  for (WindowSums<double> const& share : light) all_light += share;
  WindowLevels const means = weighted_means(all_light);
  Vec2d squares;
  threads_do([&](Window const& own, std::size_t thread) { square_shares[thread] = own.sum_squares(pixels, means); });
  for (Vec2d const& share : square_shares) squares += share;
  WindowLevels const levels = equally_bright(means, squares);
  for (int n = 0; n < Window::steps(window.side); ++n)
    threads_do([&](Window const& own, std::size_t thread) { own.step(n, pixels, levels, shares[thread]); });
  StatisticsSums sums;
  for (auto& share : shares) {
    std::vector<double> parts;
    share.each([&](double const& part) { parts.push_back(part); });
    std::size_t k = 0;
    sums.each([&](double& sum) { sum += parts[k++]; });
  }
  return sums;
}

/// The sums by their definition, in double precision, and the sums of the absolute values of their terms.
struct DefinedSums {
  StatisticsSums sums, sizes;

  explicit DefinedSums(PlainWindow const& window) {
    int const side = window.side;
    auto const n = static_cast<std::size_t>(side) * side;
    std::vector<double> w(n), a(n), b(n);
    double weight = 0.0, reference = 0.0, flow = 0.0;
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        std::size_t const k = static_cast<std::size_t>(j) * side + i, from = window.at(i, j);
        w[k] = window.weight[from];
        a[k] = window.reference[from];
        b[k] = window.flow[from];
        weight += w[k];
        reference += w[k] * a[k];
        flow += w[k] * b[k];
      }
    double of_reference = 0.0, of_flow = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      a[k] -= reference / weight;
      b[k] -= flow / weight;
      of_reference += w[k] * w[k] * a[k] * a[k];
      of_flow += w[k] * w[k] * b[k] * b[k];
    }
    for (std::size_t k = 0; k < n; ++k) {
      b[k] *= std::sqrt(of_reference / of_flow);
      add(&StatisticsSums::centre, w[k] * w[k] * a[k] * b[k]);
      add(&StatisticsSums::whole, w[k] * w[k]);
    }
    for (int axis = 0; axis < 2; ++axis) {
      int const dx = axis == 0 ? 1 : 0, dy = 1 - dx;
      std::vector<double> term(n), square(n);
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
          std::size_t const here = static_cast<std::size_t>(j) * side + i;
          auto const weighted = [&](int x, int y) {
            if (x < 0 || y < 0 || x >= side || y >= side) return 0.0;
            std::size_t const k = static_cast<std::size_t>(y) * side + x;
            return w[k] * (a[k] + b[k]);
          };
          double const share = 0.5 * w[here] * (weighted(i - dx, j - dy) - weighted(i + dx, j + dy));
          term[here] = share * (b[here] - a[here]);
          square[here] = share * share;
          add(&StatisticsSums::shares, axis, square[here]);
          add(&StatisticsSums::squares, axis, term[here] * term[here]);
          if (i + dx >= side || j + dy >= side) continue;
          std::size_t const there = static_cast<std::size_t>(j + dy) * side + (i + dx);
          double const both = w[here] * w[there];
          add(&StatisticsSums::beside, axis, 0.5 * both * (a[here] * b[there] + a[there] * b[here]));
          add(&StatisticsSums::overlap, axis, both);
        }
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
          for (int y = std::max(0, j - 2); y <= std::min(side - 1, j + 2); ++y)
            for (int x = std::max(0, i - 2); x <= std::min(side - 1, i + 2); ++x) {
              double const part = (std::abs(x - i) == 2 ? 0.5 : 1.0) * (std::abs(y - j) == 2 ? 0.5 : 1.0);
              std::size_t const k = static_cast<std::size_t>(j) * side + i, m = static_cast<std::size_t>(y) * side + x;
              add(&StatisticsSums::terms, axis, part * term[k] * term[m]);
              add(&StatisticsSums::lost, axis, part * square[k] * square[m]);
            }
    }
  }

 private:
  void add(double StatisticsSums::*sum, double value) {
    sums.*sum += value;
    sizes.*sum += std::abs(value);
  }
  void add(double (StatisticsSums::*sum)[2], int axis, double value) {
    (sums.*sum)[axis] += value;
    (sizes.*sum)[axis] += std::abs(value);
  }
};

/// Dots of one displacement in noise, half as bright in frame B; a corner of the window and single pixels are unknown.
PlainWindow noisy_window(int side, unsigned seed) {
  PlainWindow window(side);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, 0.05);
  std::uniform_real_distribution<double> place(0.0, side);
  std::vector<Vec2d> dots(static_cast<std::size_t>(side * side / 50 + 1));
  for (Vec2d& dot : dots) dot = {place(random), place(random)};
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      double light = 0.0;
      for (Vec2d const& dot : dots) light += std::exp(-0.9 * ((i - dot.x) * (i - dot.x) + (j - dot.y) * (j - dot.y)));
      double const x = (i - 0.5 * (side - 1)) / side, y = (j - 0.5 * (side - 1)) / side;
      bool const known = (i + j > side / 4) && (17 * i + 31 * j) % 23 != 0;
      window.weight[window.at(i, j)] = known ? static_cast<float>(std::exp(-3.0 * (x * x + y * y))) : 0.0f;
      window.reference[window.at(i, j)] = static_cast<float>(light + noise(random));
      window.flow[window.at(i, j)] = static_cast<float>(0.5 * (light + noise(random)) + 0.25);
    }
  return window;
}

std::vector<double> values_of(StatisticsSums sums) {
  std::vector<double> values;
  sums.each([&](double const& sum) { values.push_back(sum); });
  return values;
}

/// Each product has some 20 roundings of 6e-8, and a row of up to 48 products as many more: 4e-6 of the sum of absolute
/// values, if all had one sign.
void expect_sums(StatisticsSums const& sums, DefinedSums const& defined, char const* by) {
  std::vector<double> const found = values_of(sums), right = values_of(defined.sums), sizes = values_of(defined.sizes);
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], right[k], 4e-6 * sizes[k]) << k << ' ' << by;
}

// Windows of even and odd size, with fewer and more threads than columns, a single thread, eight columns at a time.
TEST(WindowStatistics, AreTheSumsThatDefineThem) {
  for (int const side : {4, 13, 40, 48}) {
    PlainWindow const window = noisy_window(side, static_cast<unsigned>(side));
    DefinedSums const defined(window);
    for (int const threads : {1, 7, 32, 64, 256}) {
      StatisticsSums const sums = sums_by_threads<OneColumn>(window, threads, false);
      expect_sums(sums, defined, "columns");
      EXPECT_EQ(values_of(sums), values_of(sums_by_threads<OneColumn>(window, threads, true)))
          << side << ' ' << threads;
    }
    for (int const threads : {1, 3}) {
      StatisticsSums const sums = sums_by_threads<EightColumns>(window, threads, false);
      expect_sums(sums, defined, "eight columns");
      EXPECT_EQ(values_of(sums), values_of(sums_by_threads<EightColumns>(window, threads, true))) << side;
    }
  }
}

// Dots with a thousandth of the contrast, on a background that differs by half of it from the level subtracted from the
// frames: a window without neighbours. Means are rounded to 3e-8, 6e-4 of the noise of 5e-5, the variance has twice
// that relative error, and ten times that where products cancel.
TEST(WindowStatistics, HoldForFaintDots) {
  PlainWindow window = noisy_window(40, 3);
  for (std::vector<float>* frame : {&window.reference, &window.flow})
    for (float& level : *frame) level = 0.5f + 0.001f * level;
  DefinedSums const defined(window);
  for (int axis = 0; axis < 2; ++axis) {
    double const variance = displacement_variance(defined.sums, axis);
    ASSERT_GT(variance, 0.0);
    ASSERT_LT(variance, 0.3 * largest_variance);
    for (StatisticsSums const& sums :
         {sums_by_threads<OneColumn>(window, 64, false), sums_by_threads<EightColumns>(window, 1, false)})
      EXPECT_NEAR(displacement_variance(sums, axis) / variance, 1.0, 1.2e-2) << axis;
  }
}

// Frames that differ by c in one pixel; their sum varies by g along x there and not along y: a single term, t = c g/2.
// Unknown pixels have no effect.
TEST(WindowStatistics, HaveTheNoiseOfAPixelInOneTerm) {
  PlainWindow window(16);
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 16; ++i) {
      std::size_t const k = window.at(i, j);
      window.weight[k] = i == 3 && j == 4 ? 0.0f : 1.0f;
      window.reference[k] = window.flow[k] = static_cast<float>(i);
    }
  window.flow[window.at(3, 4)] = 50.0f;
  auto const with_noise = [&](float c) {
    PlainWindow noisy = window;
    noisy.flow[noisy.at(8, 8)] += c;
    noisy.reference[noisy.at(8, 8)] -= c;  // the sum of the frames is unchanged
    noisy.flow[noisy.at(8, 12)] -= c;      // and so are their means and squares
    noisy.reference[noisy.at(8, 12)] += c;
    return sums_by_threads<OneColumn>(noisy, 32, false);
  };
  StatisticsSums const none = with_noise(0.0f), some = with_noise(0.25f);
  EXPECT_NEAR(none.terms[0], 0.0, 1e-9);
  // the sum of the frames is 2 x: differences of 4/2 times 0.5, squared, in two pixels; to a few roundings
  EXPECT_NEAR(some.terms[0], 2.0 * 1.0 * 1.0, 1e-5);
  EXPECT_NEAR(some.terms[1], 0.0, 1e-9);
  EXPECT_NEAR(some.shares[0], none.shares[0], 1e-5 * none.shares[0]);
}

// Frame B differs by 5 % whose sign alternates from pixel to pixel, like errors of interpolation: terms cancel their
// neighbours. Their sum is below a tenth of the sum of squares, but the variance is not zero.
TEST(WindowStatistics, GiveNoVarianceOfZeroWhereTermsCancel) {
  PlainWindow window(32);
  for (int j = 0; j < 32; ++j)
    for (int i = 0; i < 32; ++i) {
      double const x = i % 8 - 3.5, y = j % 8 - 3.5, r2 = x * x + y * y;
      window.weight[window.at(i, j)] = 1.0f;
      window.reference[window.at(i, j)] = static_cast<float>(std::exp(-r2 / 3.0));
      window.flow[window.at(i, j)] = static_cast<float>(((i + j) % 2 == 0 ? 1.05 : 0.95) * std::exp(-r2 / 3.0));
    }
  DefinedSums const defined(window);
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_LT(defined.sums.terms[axis], smallest_share * defined.sums.squares[axis]) << axis;
    EXPECT_GT(displacement_variance(defined.sums, axis), 0.0) << axis;
  }
}

TEST(MeanOfNeighbours, LeavesOutWhatIsNotKnown) {
  double const values[3][4] = {{1, 2, 3, 4}, {5, not_known, 7, 8}, {9, 10, 11, 12}};
  auto const mean = [&](int column, int row) {
    return mean_of_neighbours(column, row, 4, 3, [&](int x, int y) { return values[y][x]; });
  };
  EXPECT_DOUBLE_EQ(mean(0, 0), (1.0 + 2.0 + 5.0) / 3.0);
  EXPECT_DOUBLE_EQ(mean(2, 1), (2.0 + 3.0 + 4.0 + 7.0 + 8.0 + 10.0 + 11.0 + 12.0) / 8.0);
  EXPECT_DOUBLE_EQ(mean(3, 2), (7.0 + 8.0 + 11.0 + 12.0) / 4.0);
  EXPECT_TRUE(std::isnan(mean(1, 1)));
}

ParticlePair masked_pair(double unit) {
  ParticlePair pair = render_particle_pair({.columns = 203, .rows = 180, .noise = 0.03, .seed = 7}, [](Vec2d p) {
    return Vec2d{0.6 + 0.01 * p.y, -0.8};
  });
  for (Image<double>* image : {&pair.reference, &pair.flow})
    for (double& value : *image) value *= unit;
  for (int j = 60; j < 100; ++j)
    for (int i = 70; i < 120; ++i) pair.reference(i, j) = not_known;
  return pair;
}

DisplacementField field_with_sigma(HostFrames const& frames, CorrelationSettings const& settings) {
  DisplacementField field = make_correlator(settings)->correlate_pair(frames);
  estimate_uncertainty(field, frames, settings);
  return field;
}

// A complete pair, including the border, masked windows and both weightings, compared with the definition in double
// precision: the products of a window cancel to a twentieth of their size at most, so that 4e-6 of these are 8e-5 of
// the variance and 4e-5 of sigma.
TEST(CorrelationStatistics, AreThoseOfTheMatchedWindows) {
  ParticlePair const pair = masked_pair(1.0);
  HostFrames const frames(pair.reference, pair.flow);
  for (char const* weighting : {"gaussian", "uniform"}) {
    CorrelationSettings settings;
    settings.weighting = weighting;
    settings.window_px = {48, 32, 20};
    settings.uncertainty = "correlation_statistics";
    DisplacementField const field = field_with_sigma(frames, settings);
    InterrogationGrid const grid = final_grid(settings, frames.reference().columns(), frames.reference().rows());
    std::vector<GridVector> vectors(field.size());
    for (std::size_t i = 0; i < field.size(); ++i) {
      vectors[i].displacement = field.displacement_px[i];
      vectors[i].status = field.status[i];
    }
    DensePredictor const predictor(
        grid, smoothed_displacement(filled_displacement(vectors, grid.columns), grid.columns, 0.25),
        frames.reference().columns(), frames.reference().rows());
    ImagePair const matched =
        PairDeformer(frames.reference(), frames.flow(), CorrelationSchedule(settings).spline_degree())
            .deform(predictor);
    std::vector<double> u(field.size(), not_known), v(u);
    visit_matched_windows({field, matched, grid, settings}, [&](std::size_t i, MatchedWindow const& from) {
      PlainWindow window(from.side);
      for (int y = 0; y < from.side; ++y)
        for (int x = 0; x < from.side; ++x) {
          window.weight[window.at(x, y)] = from.weight[from.at(x, y)];
          window.reference[window.at(x, y)] = from.reference[from.at(x, y)];
          window.flow[window.at(x, y)] = from.flow[from.at(x, y)];
        }
      DefinedSums const defined(window);
      u[i] = displacement_variance(defined.sums, 0);
      v[i] = displacement_variance(defined.sums, 1);
    });
    std::vector<Vec2d> const expected = sigma_of_variances(u, v, grid);
    double const amplification = amplification_of_passes(settings);
    std::size_t known = 0;
    for (std::size_t i = 0; i < field.size(); ++i) {
      ASSERT_EQ(std::isnan(field.sigma_px[i].x), std::isnan(expected[i].x)) << i;
      ASSERT_EQ(std::isnan(field.sigma_px[i].y), std::isnan(expected[i].y)) << i;
      if (std::isnan(expected[i].x)) continue;
      ++known;
      EXPECT_NEAR(field.sigma_px[i].x / (amplification * expected[i].x), 1.0, 4e-5) << i;
      EXPECT_NEAR(field.sigma_px[i].y / (amplification * expected[i].y), 1.0, 4e-5) << i;
    }
    EXPECT_GT(known, field.size() / 2) << weighting;
    EXPECT_LT(known, field.size()) << weighting;
  }
}

// The unit of the grey levels is arbitrary, to the accuracy of the vectors themselves: below 1e-6 px. A sigma changes
// by no more than the vector by which its frames are matched.
TEST(CorrelationStatistics, DoNotDependOnTheUnitOfGrey) {
  CorrelationSettings settings;
  settings.window_px = {32, 20};
  settings.uncertainty = "correlation_statistics";
  auto const sigma_in = [&](double unit) {
    ParticlePair pair = masked_pair(unit);
    return field_with_sigma(HostFrames(std::move(pair.reference), std::move(pair.flow)), settings).sigma_px;
  };
  std::vector<Vec2d> const expected = sigma_in(1.0);
  for (double const unit : {0x1p-50, 0x1p50}) {
    std::vector<Vec2d> const sigma = sigma_in(unit);
    ASSERT_EQ(sigma.size(), expected.size());
    for (std::size_t i = 0; i < sigma.size(); ++i) {
      EXPECT_EQ(std::isnan(sigma[i].x), std::isnan(expected[i].x)) << i;
      if (!std::isnan(expected[i].x)) {
        EXPECT_LT(length(sigma[i] - expected[i]), 1e-6) << unit << ' ' << i;
      }
    }
  }
}

}  // namespace
}  // namespace gladstone
