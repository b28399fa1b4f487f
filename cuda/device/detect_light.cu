#include <algorithm>
#include <bit>

#include "cuda/device/detect_light.h"
#include "cuda/device/launch.h"
#include "cuda/device/ordered_key.cuh"

namespace gladstone::cuda::inline device {
namespace {

constexpr int threads = 256;

__device__ std::size_t first_item() { return blockIdx.x * std::size_t{threads} + threadIdx.x; }
__device__ std::size_t stride() { return gridDim.x * std::size_t{threads}; }

__global__ void take_from_white_kernel(double const* white, double* light, std::size_t count) {
  for (std::size_t i = first_item(); i < count; i += stride()) light[i] = white[i] - light[i];
}

__global__ void find_brightest_kernel(double const* light, std::size_t count, unsigned long long* key) {
  unsigned long long highest = 0;
  for (std::size_t i = first_item(); i < count; i += stride()) highest = max(highest, ordered_key(light[i]));
  for (int offset = 16; offset > 0; offset /= 2) highest = max(highest, __shfl_xor_sync(0xffffffffu, highest, offset));
  if (threadIdx.x % 32 == 0) atomicMax(key, highest);
}

__global__ void record_levels_kernel(PixelDetector const detector, RandomStream const stream, double const* light,
                                     std::size_t count, double* levels, unsigned long long* saturated) {
  unsigned int clipped = 0;
  for (std::size_t i = first_item(); i < count; i += stride()) {
    PixelLevel const here = detector.record(light[i], stream, i);
    levels[i] = here.level;
    clipped += here.saturated ? 1 : 0;
  }
  clipped = __reduce_add_sync(0xffffffffu, clipped);
  if (threadIdx.x % 32 == 0 && clipped > 0) atomicAdd(saturated, static_cast<unsigned long long>(clipped));
}

__global__ void ideal_levels_kernel(PixelDetector const detector, double const* light, std::size_t count,
                                    double* levels) {
  for (std::size_t i = first_item(); i < count; i += stride()) levels[i] = detector.ideal(light[i]);
}

template <class Kernel, class... Arguments>
void launch(char const* name, Kernel* kernel, std::size_t count, Arguments... arguments) {
  kernel<<<blocks_for(kernel, threads, 0, (count + threads - 1) / threads), threads>>>(arguments...);
  check_launch(name);
}

}  // namespace

void take_from_white(double const* white, double* light, std::size_t count) {
  launch("take_from_white", take_from_white_kernel, count, white, light, count);
}

void find_brightest(double const* light, std::size_t count, unsigned long long* key) {
  launch("find_brightest", find_brightest_kernel, count, light, count, key);
}

double brightness_from_key(unsigned long long key) {
  return std::bit_cast<double>(key >> 63 ? key & 0x7fffffffffffffffull : ~key);
}

void record_levels(PixelDetector const& detector, RandomStream stream, double const* light, std::size_t count,
                   double* levels, unsigned long long* saturated) {
  launch("record_levels", record_levels_kernel, count, detector, stream, light, count, levels, saturated);
}

void ideal_levels(PixelDetector const& detector, double const* light, std::size_t count, double* levels) {
  launch("ideal_levels", ideal_levels_kernel, count, detector, light, count, levels);
}

}  // namespace gladstone::cuda::inline device
