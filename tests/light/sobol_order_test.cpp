#include "render/base/sobol_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "render/base/random.h"

namespace gladstone {
namespace {

struct Seeds {
  std::uint32_t radius, angle;
};

/// Returns seeds with many different bit patterns.
std::vector<Seeds> some_seeds() {
  std::vector<Seeds> seeds{{0, 0}, {0xffffffffu, 1u}};
  for (std::uint64_t k = 0; k < 6; ++k) {
    std::uint64_t const bits = random_bits(3, RandomStream::pupil, k);
    seeds.push_back({static_cast<std::uint32_t>(bits), static_cast<std::uint32_t>(bits >> 32)});
  }
  return seeds;
}

// The counts have one block, many blocks, and blocks of one point.
TEST(SobolOrder, IsAPermutationOfThePoints) {
  for (Seeds const seed : some_seeds()) {
    for (std::uint32_t const count : {0u, 1u, 2u, 3u, 4u, 7u, 32u, 127u, 1250u, 2048u, 4097u}) {
      std::vector<std::uint32_t> points(count), all(count);
      for (std::uint32_t place = 0; place < count; ++place) {
        points[place] = ordered_point(place, count, seed.radius, seed.angle);
      }
      std::iota(all.begin(), all.end(), 0u);
      std::sort(points.begin(), points.end());
      EXPECT_EQ(points, all) << count;
      EXPECT_EQ(ordered_point(count, count, seed.radius, seed.angle), count);
      EXPECT_EQ(ordered_point(count + 5, count, seed.radius, seed.angle), count + 5);
    }
  }
}

// The leading digits of the scrambled coordinates are those of the place: the first digit of the place is the first one
// of the angle, the others are the second of the angle, the first of the radius, the third of the angle, and so on.
// They therefore do not depend on the seeds, and 2^k adjacent places are in one rectangle of 2^k / 2^m of the unit
// square.
TEST(SobolOrder, PlacesAreRectanglesThatDoNotDependOnTheSeeds) {
  constexpr std::uint32_t count = 1024 + 128 + 64 + 32 + 2;
  for (Seeds const seed : some_seeds()) {
    for (std::uint32_t place = 0; place < count; ++place) {
      std::uint32_t const point = ordered_point(place, count, seed.radius, seed.angle);
      std::uint32_t const radius = owen_scramble(sobol_bits(point, 0), seed.radius);
      std::uint32_t const angle = owen_scramble(sobol_bits(point, 1), seed.angle);
      // the blocks begin at 0, 1024, 1152, 1216 and 1248
      int const digits = place < 1024 ? 10 : (place < 1152 ? 7 : (place < 1216 ? 6 : (place < 1248 ? 5 : 1)));
      std::uint32_t found = 0;
      int of_radius = 0, of_angle = 0;
      for (int k = 0; k < digits; ++k) {
        bool const radial = k >= 2 && k % 2 == 0;
        std::uint32_t const digit = radial ? radius >> (31 - of_radius++) : angle >> (31 - of_angle++);
        found = 2 * found + (digit & 1u);
      }
      ASSERT_EQ(found, place & ((1u << digits) - 1)) << place;
    }
  }
}

}  // namespace
}  // namespace gladstone
