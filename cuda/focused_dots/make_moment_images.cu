#include "cuda/device/cuda_error.h"
#include "cuda/focused_dots/dot_cones.h"

namespace gladstone::cuda {
namespace {

constexpr int threads = 128;

/// A block works out all images of a phase and moment, a thread a pixel of them.
__global__ void __launch_bounds__(threads)
    make_moment_images_kernel(DotModel const __grid_constant__ model, double* const out) {
  MomentImages const& images = model.moment_images;
  GaussianSpot<double> const spot = model.spot;
  int const phase = static_cast<int>(blockIdx.x), moment = static_cast<int>(blockIdx.y), width = images.width();
  int order = 0;
  while (moment >= DisplacementMoments::at(order, 0) + order + 1) ++order;
  int const b = moment - DisplacementMoments::at(order, 0), a = order - b;
  for (int pixel = threadIdx.x; pixel < images.stride; pixel += threads) {
    int const column = pixel % width - images.half, row = pixel / width - images.half;
    double sum[PlaceRule::terms] = {};
    for (int i = 0; i < model.source.count; ++i) {
      Vec2d const place = model.source.points[i], at = images.middle(phase) + model.half_size_px() * place;
      Footprint const reach = spot.footprint(at);
      if (column < reach.column || column >= reach.column + reach.width) continue;
      if (row < reach.row || row >= reach.row + reach.width) continue;
      double const share =
          model.source.weights[i] * spot.taylor_share(at.x, column, a) * spot.taylor_share(at.y, row, b);
      double basis[PlaceRule::terms];
      PlaceRule::basis(place, basis);
      for (int term = 0; term < PlaceRule::terms; ++term) sum[term] += share * basis[term];
    }
    double* const first =
        out + (static_cast<std::size_t>(phase) * images.count() + moment * images.terms) * images.stride + pixel;
#pragma unroll
    for (int term = 0; term < PlaceRule::terms; ++term) {
      if (term < images.terms) first[static_cast<std::size_t>(term) * images.stride] = sum[term];
    }
  }
}

}  // namespace

void make_moment_images(DotModel const& model, double* out) {
  dim3 const blocks(static_cast<unsigned>(model.moment_images.phases()), DisplacementMoments::count);
  make_moment_images_kernel<<<blocks, threads>>>(model, out);
  check_launch("make_moment_images");
}

}  // namespace gladstone::cuda
