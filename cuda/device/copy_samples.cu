#include <cstddef>

#include "cuda/device/copy_samples.h"
#include "cuda/device/launch.h"

namespace gladstone::cuda::inline device {
namespace {

constexpr int threads = 256;

template <class Sample>
__global__ void copy_samples_kernel(ImageSamples const image, double* levels, unsigned long long* not_finite) {
  auto const* const first = static_cast<Sample const*>(image.first);
  auto const count = static_cast<std::size_t>(image.columns * image.rows);
  unsigned int bad = 0;
  for (std::size_t i = blockIdx.x * std::size_t{threads} + threadIdx.x; i < count;
       i += gridDim.x * std::size_t{threads}) {
    auto const row = static_cast<std::int64_t>(i) / image.columns,
               column = static_cast<std::int64_t>(i) % image.columns;
    double const level = static_cast<double>(first[row * image.row_step + column * image.column_step]);
    levels[i] = level;
    bad += isfinite(level) ? 0 : 1;
  }
  bad = __reduce_add_sync(0xffffffffu, bad);
  if (threadIdx.x % 32 == 0 && bad > 0) atomicAdd(not_finite, static_cast<unsigned long long>(bad));
}

}  // namespace

void copy_samples(ImageSamples const& image, double* levels, unsigned long long* not_finite) {
  auto const count = static_cast<std::size_t>(image.columns * image.rows);
  visit_sample_type(image, [&](auto type) {
    auto* const kernel = copy_samples_kernel<decltype(type)>;
    kernel<<<blocks_for(kernel, threads, 0, (count + threads - 1) / threads), threads>>>(image, levels, not_finite);
    check_launch("copy_samples");
  });
}

}  // namespace gladstone::cuda::inline device
