#pragma once

#include <cstdint>

#include "render/base/host_device.h"

namespace gladstone::inline base {

/// Independent random streams of a case. Each random number is a function of its key (seed, stream, source, ray), not
/// of the order of calls, so that runs repeat on any number of threads and on either device.
enum class RandomStream : std::uint64_t {
  target = 1,
  pupil = 2,
  noise_reference = 3,
  noise_flow = 4,
  particles = 5,
  sensor = 6
};

/// Bijective 64-bit mixing function (Steele, Lea & Flood 2014, SplitMix64, with the constants of Stafford's variant
/// 13).
GLADSTONE_HD constexpr std::uint64_t mix64(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

/// Returns the 64 random bits of a key of up to four numbers.
GLADSTONE_HD constexpr std::uint64_t random_bits(std::uint64_t seed, RandomStream stream, std::uint64_t a,
                                                 std::uint64_t b = 0) {
  std::uint64_t h = mix64(seed + 0x9e3779b97f4a7c15ULL);
  h = mix64(h ^ (static_cast<std::uint64_t>(stream) * 0xd1342543de82ef95ULL));
  h = mix64(h ^ (a + 0x9e3779b97f4a7c15ULL));
  return mix64(h ^ (b * 0xda942042e4dd58b5ULL + 0x2545f4914f6cdd1dULL));
}

/// Returns the seed of repetition `repeat` of a case, statistically independent of its other repetitions; repetition 0
/// has the case's own seed.
constexpr std::uint64_t repeat_seed(std::uint64_t seed, std::uint64_t repeat) {
  return repeat == 0 ? seed : mix64(mix64(seed + 0x632be59bd9b4e019ULL) + repeat * 0x9e3779b97f4a7c15ULL);
}

/// Converts random bits to a uniform number in [0, 1) with 53 bits of precision.
GLADSTONE_HD constexpr double to_unit(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

/// Random bit generator (C++ UniformRandomBitGenerator) of one pixel or item, started from the key (seed, stream,
/// item).
class KeyedEngine {
 public:
  using result_type = std::uint64_t;
  GLADSTONE_HD KeyedEngine(std::uint64_t seed, RandomStream stream, std::uint64_t item)
      : key_(random_bits(seed, stream, item)) {}
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }
  GLADSTONE_HD result_type operator()() { return mix64(key_ += 0x9e3779b97f4a7c15ULL); }

 private:
  std::uint64_t key_;
};

}  // namespace gladstone::inline base
