#include "cuda/device/cuda_error.h"
#include "cuda/focused_dots/dot_cones.h"
#include "cuda/focused_dots/dot_groups.cuh"

namespace gladstone::cuda::inline focused_dots {
namespace {

/// Computes all images of one sub-pixel phase and moment per block. The output must be initialised to zero.
__global__ void __launch_bounds__(dot_threads)
    make_moment_images_kernel(DotModel const __grid_constant__ model, double* const out) {
  constexpr int most_points = 16, room = 2048;
  __shared__ double factors[room];
  MomentImages const& images = model.moment_images;
  int const phase = static_cast<int>(blockIdx.x), moment = static_cast<int>(blockIdx.y);
  double* const first =
      out + (static_cast<std::size_t>(phase) * images.count() + moment * images.terms) * images.stride;
  add_to_images<1, 1>(Block{}, images, model.source, model.half_size_px(), model.spot, phase, moment, first, factors,
                      min(most_points, room / MomentImages::factors(2 * model.spot.half_width() + 2)));
}

}  // namespace

void make_moment_images(DotModel const& model, double* out) {
  dim3 const blocks(static_cast<unsigned>(model.moment_images.phases()), DisplacementMoments::count);
  make_moment_images_kernel<<<blocks, dot_threads>>>(model, out);
  check_launch("make_moment_images");
}

}  // namespace gladstone::cuda::inline focused_dots
