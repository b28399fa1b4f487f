#include <algorithm>
#include <cstdint>

#include "cuda/device/launch.h"
#include "cuda/ideal_images/pair_kernels.h"
#include "cuda/ideal_images/tile_lists.cuh"

namespace gladstone::cuda::inline ideal_images {
namespace {

constexpr int threads = 128;                  // three blocks then fill the registers of a multiprocessor
constexpr std::size_t pixels_per_thread = 8;  // so that a thread loads the detector once for several pixels
constexpr unsigned int most_rows = 65535;     // maximum extent of a grid along y

__device__ double value_of(unsigned long long bits) { return __longlong_as_double(static_cast<long long>(bits)); }

__global__ void particle_kernel(PairsOnDevice const pairs, std::size_t count, ParticleImage* images,
                                unsigned long long* unit, TileLists const lists) {
  std::size_t const particle = blockIdx.x * std::size_t{threads} + threadIdx.x;
  for (std::size_t pair = blockIdx.y; pair < pairs.pairs; pair += gridDim.y) {
    PairModel const& model = pairs.model(pair);
    ParticleImage image[2];
    if (particle < model.seeded) model.images(pairs.seeds[pair].particles, particle, image);
    double most = 0;
    for (std::size_t frame = 0; frame < 2 && particle < count; ++frame) {
      images[(2 * pair + frame) * count + particle] = image[frame];
      enter_image(lists, model.spot, 2 * pair + frame, static_cast<std::uint32_t>(particle), image[frame]);
      most = max(most, image[frame].light);
    }
    for (int offset = 16; offset > 0; offset /= 2) most = max(most, __shfl_xor_sync(0xffffffffu, most, offset));
    if (threadIdx.x % 32 == 0 && most > 0)
      atomicMax(unit + pair, static_cast<unsigned long long>(__double_as_longlong(most)));
  }
}

template <class Level>
__global__ void record_kernel(PairsOnDevice const pairs, double const* light, std::size_t pixels,
                              unsigned long long const* brightest, unsigned long long const* unit, Level* levels) {
  for (std::size_t frame = blockIdx.y; frame < 2 * pairs.pairs; frame += gridDim.y) {
    std::size_t const pair = frame / 2;
    PairModel const& model = pairs.model(pair);
    PixelDetector detector = model.detector;
    detector.seed = pairs.seeds[pair].noise;
    double const photons = value_of(unit[pair]);  // 0: no particle is illuminated
    detector.electrons = model.exposure.electrons(value_of(brightest[pair]), photons > 0 ? photons : 1);
    RandomStream const stream = frame % 2 == 0 ? RandomStream::noise_reference : RandomStream::noise_flow;
    for (std::size_t pixel = blockIdx.x * std::size_t{threads} + threadIdx.x; pixel < pixels;
         pixel += gridDim.x * std::size_t{threads}) {
      PixelLevel const recorded = detector.record(light[frame * pixels + pixel], stream, pixel);
      if constexpr (std::is_same_v<Level, float>) {
        levels[frame * pixels + pixel] = static_cast<float>(recorded.level / detector.full_scale);
      } else {
        levels[frame * pixels + pixel] = static_cast<Level>(recorded.level);
      }
    }
  }
}

__global__ void displacement_kernel(PairModel const* models, std::size_t count, int columns, int rows, float* out) {
  std::size_t const pixels = static_cast<std::size_t>(columns) * rows;
  std::size_t const pixel = blockIdx.x * std::size_t{threads} + threadIdx.x;
  if (pixel >= pixels) return;
  for (std::size_t model = blockIdx.y; model < count; model += gridDim.y) {
    Vec2d const at{static_cast<double>(pixel % columns), static_cast<double>(pixel / columns)};
    Vec2d const moved = models[model].displacement(at);
    out[2 * model * pixels + pixel] = static_cast<float>(moved.x);
    out[(2 * model + 1) * pixels + pixel] = static_cast<float>(moved.y);
  }
}

dim3 grid(std::size_t items, std::size_t rows) {
  return {static_cast<unsigned int>((items + threads - 1) / threads),
          static_cast<unsigned int>(std::min<std::size_t>(rows, most_rows))};
}

}  // namespace

void make_particle_images(PairsOnDevice const& pairs, std::size_t count, ParticleImage* images,
                          unsigned long long* unit, TileLists const& lists) {
  if (count == 0) return;
  particle_kernel<<<grid(count, pairs.pairs), threads>>>(pairs, count, images, unit, lists);
  check_launch("make_particle_images");
}

void record_pairs(PairsOnDevice const& pairs, double const* light, std::size_t pixels,
                  unsigned long long const* brightest, unsigned long long const* unit, LevelType type, void* levels) {
  auto const record = [&]<class Level>(Level* out) {
    record_kernel<<<grid((pixels + pixels_per_thread - 1) / pixels_per_thread, 2 * pairs.pairs), threads>>>(
        pairs, light, pixels, brightest, unit, out);
  };
  switch (type) {
    case LevelType::float32:
      record(static_cast<float*>(levels));
      break;
    case LevelType::uint8:
      record(static_cast<std::uint8_t*>(levels));
      break;
    case LevelType::uint16:
      record(static_cast<std::uint16_t*>(levels));
      break;
  }
  check_launch("record_pairs");
}

void compute_displacements(PairModel const* models, std::size_t count, int columns, int rows, float* out) {
  std::size_t const pixels = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  displacement_kernel<<<grid(pixels, count), threads>>>(models, count, columns, rows, out);
  check_launch("compute_displacements");
}

}  // namespace gladstone::cuda::inline ideal_images
