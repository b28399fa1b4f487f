#include "cuda/correlation/paired_plane.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

namespace gladstone::cuda {
namespace {

constexpr int pitch = 73, pairs = 24, middle = 12, above = 32;
using Maximum = std::tuple<int, int, float>;

/// Plane of random integers from -2 to `levels`: the smaller `levels`, the more neighbours are equal.
class RandomPlane {
 public:
  RandomPlane(int levels, unsigned seed) : memory_(pitch * pairs) {
    std::mt19937 generator(seed);
    std::uniform_int_distribution<int> level(-2, levels);
    for (Complex& value : memory_) value = {static_cast<float>(level(generator)), static_cast<float>(level(generator))};
  }
  PairedPlane<pitch> view() const { return {memory_.data() + middle * pitch + above}; }

 private:
  std::vector<Complex> memory_;
};

/// Maxima by definition, in reading order.
std::vector<Maximum> all_maxima(PairedPlane<pitch> const& plane, int radius) {
  std::vector<Maximum> maxima;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x)
      if (float const height = plane(x, y); height > 0.0f && is_maximum(plane, x, y, height))
        maxima.emplace_back(y, x, height);
  return maxima;
}

std::vector<Maximum> maxima_of_blocks(PairedPlane<pitch> const& plane, int radius) {
  std::vector<Maximum> maxima;
  for (int thread = 0; thread < 32 * SearchBlock::warps; ++thread) {
    SearchBlock const block(thread, radius);
    if (block.x > radius || block.y > radius) continue;
    PlanePeak<float> found[2];
    maxima_of_block(plane, radius, block.x, block.y, found);
    for (PlanePeak<float> const& peak : found)
      if (peak.height > 0.0f) maxima.emplace_back(peak.y, peak.x, peak.height);
  }
  std::sort(maxima.begin(), maxima.end());
  return maxima;
}

TEST(PairedPlane, HasColumnsSideBySide) {
  RandomPlane const random(1000, 1);
  Complex const* const centre = random.view().centre;
  EXPECT_EQ(random.view()(0, 3), centre[3].re);
  EXPECT_EQ(random.view()(1, 3), centre[3].im);
  EXPECT_EQ(random.view()(-1, -3), centre[-pitch - 3].im);
  EXPECT_EQ(random.view()(-2, -3), centre[-pitch - 3].re);
}

// Among equal neighbours, the first in reading order is a maximum, as in is_maximum().
TEST(PairedPlane, ItsBlocksHaveEveryMaximumOnce) {
  for (int radius = 1; radius <= 16; ++radius)
    for (int const levels : {1, 3, 1000}) {
      RandomPlane const random(levels, static_cast<unsigned>(radius));
      EXPECT_EQ(maxima_of_blocks(random.view(), radius), all_maxima(random.view(), radius)) << radius << ", " << levels;
    }
}

}  // namespace
}  // namespace gladstone::cuda
