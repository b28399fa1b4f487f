#pragma once

namespace gladstone::cuda::inline device {

/// Conversion between floating-point numbers and unsigned integers of the same order, for atomicMax. Key 0 is below
/// those of all numbers.
__device__ inline unsigned long long ordered_key(double value) {
  auto const bits = static_cast<unsigned long long>(__double_as_longlong(value));
  return bits >> 63 ? ~bits : bits | 0x8000000000000000ull;
}

__device__ inline double key_value(unsigned long long key) {
  return __longlong_as_double(static_cast<long long>(key >> 63 ? key & 0x7fffffffffffffffull : ~key));
}

}  // namespace gladstone::cuda::inline device
