#include "cuda/correlation/window_transform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace gladstone::cuda {
namespace {

using Transform = WindowTransform;
constexpr int size = Transform::size, count = size * size;
constexpr int warps = Transform::threads / 32;

/// Executes the threads of a block one after the other, in ascending or descending order: if threads exchanged values
/// without a barrier in between, the results of the two orders would differ.
class Block {
 public:
  explicit Block(bool falling) : falling_(falling), memory_(Transform::values) {
    float const nothing = std::numeric_limits<float>::quiet_NaN();
    std::fill(memory_.begin(), memory_.end(), Complex{nothing, nothing});
    for (unsigned k = 0; k < Transform::threads; ++k) thread_.emplace_back(k, memory_.data(), &roots);
  }

  /// Returns the correlation at shifts up to radius + 1 along either axis, row by row.
  std::vector<float> correlate(std::vector<float> const& a, std::vector<float> const& b, int radius) {
    warps_do([&](int warp) {
      lanes_do(warp, [&](int k) {
        Complex z[2][8];
        for (int half = 0; half < 2; ++half)
          for (int r = 0; r < 8; ++r) {
            int const at = (warp + 8 * r) * size + k % 32 + 32 * half;
            z[half][r] = {a[at], b[at]};
          }
        thread_[k].column_first_pass(z);
      });
    });
    warps_do([&](int warp) { lanes_do(warp, [&](int k) { thread_[k].column_second_pass(); }); });
    warps_do([&](int warp) { rows(warp); });
    warps_do([&](int warp) { columns(warp, radius); });
    auto const plane = thread_[0].plane(radius);
    std::vector<float> values;
    for (int dy = -radius - 1; dy <= radius + 1; ++dy)
      for (int dx = -radius - 1; dx <= radius + 1; ++dx) values.push_back(plane(dx, dy) / (4 * count));
    return values;
  }

 private:
  static constexpr Transform::Roots roots = Transform::make_roots();

  template <class Work>
  void warps_do(Work const& work) const {
    for (int k = 0; k < warps; ++k) work(falling_ ? warps - 1 - k : k);
  }
  template <class Work>
  void lanes_do(int warp, Work const& work) const {
    for (int k = 0; k < 32; ++k) work(32 * warp + (falling_ ? 31 - k : k));
  }

  /// Steps of a warp on its rows, without barriers for other warps.
  void rows(int warp) {
    struct Lines {
      Complex a[8], b[8];
    };
    std::vector<Lines> of(Transform::threads);
    bool const packed = thread_[32 * warp].has_packed_row();
    lanes_do(warp, [&](int k) { thread_[k].row_first_pass(of[k].a, of[k].b); });
    lanes_do(warp, [&](int k) { thread_[k].keep_rows(of[k].a, of[k].b); });
    lanes_do(warp, [&](int k) { thread_[k].row_second_pass(of[k].a, of[k].b); });
    lanes_do(warp, [&](int k) {
      if (packed) thread_[k].keep_packed(of[k].a, of[k].b);
      Transform::product(of[k].a, of[k].b);
    });
    if (packed) {
      lanes_do(warp, [&](int k) { thread_[k].multiply_packed(); });
      lanes_do(warp, [&](int k) { thread_[k].take_packed(of[k].a); });
    }
    lanes_do(warp, [&](int k) { thread_[k].inverse_row_first_pass(of[k].a); });
    lanes_do(warp, [&](int k) { thread_[k].inverse_row_second_pass(of[k].a); });
    lanes_do(warp, [&](int k) { thread_[k].keep_shifts(of[k].a); });
  }

  /// Steps of a warp on its columns of the plane.
  void columns(int warp, int radius) {
    if (!thread_[32 * warp].has_columns(radius)) return;
    struct Column {
      Complex g[8];
    };
    std::vector<Column> of(Transform::threads);
    lanes_do(warp, [&](int k) { thread_[k].inverse_column_first_pass(radius); });
    lanes_do(warp, [&](int k) { thread_[k].inverse_column_second_pass(of[k].g); });
    lanes_do(warp, [&](int k) { thread_[k].keep_plane(of[k].g); });
  }

  bool falling_;
  std::vector<Complex> memory_;
  std::vector<Transform> thread_;
};

std::vector<float> noise(unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<float> normal;
  std::vector<float> values(count);
  for (float& value : values) value = normal(generator);
  return values;
}

double norm(std::vector<float> const& values) {
  double sum = 0;
  for (float const v : values) sum += static_cast<double>(v) * v;
  return std::sqrt(sum);
}

constexpr int largest_radius = Transform::largest_radius;

// The correlation at shift d is the sum over p of a(p) b(p + d), p + d modulo 64. Four transforms of twelve levels,
// each with a rounding error of 6e-8 rms, have an error of 4 sqrt(12) 6e-8 = 8e-7 of the product of the norms, in the
// norm of the whole plane, and hence no larger error in any value.
TEST(WindowTransform, GivesTheSumsThatDefineACorrelation) {
  std::vector<float> const a = noise(1), b = noise(2);
  double const tolerance = 1e-6 * norm(a) * norm(b);
  constexpr int most = largest_radius + 1;
  std::vector<double> sums;
  for (int dy = -most; dy <= most; ++dy)
    for (int dx = -most; dx <= most; ++dx) {
      double sum = 0;
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
          sum += static_cast<double>(a[y * size + x]) * b[((y + dy) & (size - 1)) * size + ((x + dx) & (size - 1))];
      sums.push_back(sum);
    }
  for (int radius = 1; radius <= largest_radius; ++radius) {
    std::vector<float> const plane = Block(false).correlate(a, b, radius);
    int const reach = radius + 1, side = 2 * reach + 1;
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx)
        ASSERT_NEAR(plane[(dy + reach) * side + dx + reach], sums[(dy + most) * (2 * most + 1) + dx + most], tolerance)
            << dx << ", " << dy << " within " << radius;
  }
}

// The correlation of a window with its copy shifted by (5, -7) is the shifted autocorrelation.
TEST(WindowTransform, HasItsPeakWhereAWindowMoved) {
  std::vector<float> const a = noise(3);
  std::vector<float> b(count);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) b[((y - 7) & (size - 1)) * size + ((x + 5) & (size - 1))] = a[y * size + x];
  std::vector<float> const plane = Block(false).correlate(a, b, largest_radius);
  auto const highest = std::max_element(plane.begin(), plane.end()) - plane.begin();
  constexpr int reach = largest_radius + 1, side = 2 * reach + 1;
  EXPECT_EQ(highest % side - reach, 5);
  EXPECT_EQ(highest / side - reach, -7);
  EXPECT_NEAR(*std::max_element(plane.begin(), plane.end()), norm(a) * norm(a), 1e-6 * norm(a) * norm(a));
}

TEST(WindowTransform, DoesNotDependOnTheOrderOfThreadsBetweenBarriers) {
  std::vector<float> const a = noise(4), b = noise(5);
  for (int radius = 1; radius <= largest_radius; ++radius)
    EXPECT_EQ(Block(false).correlate(a, b, radius), Block(true).correlate(a, b, radius)) << radius;
}

}  // namespace
}  // namespace gladstone::cuda
