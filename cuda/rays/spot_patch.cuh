#pragma once

#include "cuda/rays/lay_down_spot.cuh"
#include "cuda/rays/trace_particles.h"

namespace gladstone::cuda {

/// A square of pixels in shared memory, where a warp gathers the Gaussian spots of few rays: 32 at a time, a lane works
/// out the shares that columns and rows have of its ray, then every lane sums over all rays in its pixels. Shares are
/// kept to 1e-6, a fifteenth of a level of 16 bits.
struct SpotPatch {
  double* light = nullptr;  ///< [side][side], in units of the image; null: takes nothing
  float* columns;           ///< [ray][side]: shares
  float* rows;              ///< [ray][side]: shares times light
  int side, left, top;

  GLADSTONE_HD static std::size_t bytes(int side) {
    auto const pixels = static_cast<std::size_t>(side);
    return pixels * pixels * sizeof(double) + 2 * warp_size * pixels * sizeof(float);
  }
  __device__ SpotPatch() = default;
  __device__ SpotPatch(unsigned char* memory, LightSquare const& square)
      : light(reinterpret_cast<double*>(memory)), side(square.side), left(square.left), top(square.top) {
    columns = reinterpret_cast<float*>(light + side * side);
    rows = columns + warp_size * side;
  }

  __device__ void clear() const {
    for (int k = threadIdx.x; k < side * side; k += warp_size) light[k] = 0;
  }

  /// Takes the rays of a warp in, one a lane, of the first `lanes`. @param units of light; 0: none @return false where
  /// this lane's lies elsewhere
  __device__ bool take(SpotView const& spot, Vec2d p, double units, int lanes) const {
    int const lane = threadIdx.x;
    int const half = spot.half_width(), width = 2 * half + 1;
    bool taken = false;
    int column = 0, row = 0;
    if (units != 0 && fabs(p.x) < 1e7 && fabs(p.y) < 1e7) {
      column = static_cast<int>(floor(p.x + 0.5)) - half - left;
      row = static_cast<int>(floor(p.y + 0.5)) - half - top;
      taken = column >= 0 && row >= 0 && column + width <= side && row + width <= side;
    }
    __syncwarp();  // all have done with the rays before
    if (lane < lanes) {
      shares(spot.gaussian.sigma, p.x - left, taken ? column : side, width, 1, columns + lane * side);
      shares(spot.gaussian.sigma, p.y - top, taken ? row : side, width, taken ? units : 0, rows + lane * side);
    }
    unsigned int const any = __ballot_sync(whole_warp, taken);
    __syncwarp();
    for (int k = lane; any != 0 && k < side * side; k += warp_size) {
      float const *of_column = columns + k % side, *of_row = rows + k / side;
      float sum = 0;
      for (int ray = 0; ray < lanes; ++ray) sum += of_column[ray * side] * of_row[ray * side];
      light[k] += static_cast<double>(sum);
    }
    return taken || units == 0;
  }

  /// Sends what was gathered to the image.
  __device__ void flush(DeviceImages const& images, int frame) const {
    __syncwarp();
    for (int k = threadIdx.x; k < side * side; k += warp_size) {
      if (light[k] != 0) {
        add_light(images, static_cast<Frame>(frame), left + k % side, top + k / side, whole_units(light[k]));
      }
    }
    __syncwarp();
  }

 private:
  /// Shares of `width` pixels from `first` on of light at p, times a factor; of others 0.
  __device__ void shares(double sigma, double p, int first, int width, double factor, float* out) const {
    auto const edge = [&](int i) { return GaussianSpot<float>::edge_value(static_cast<float>((i - 0.5 - p) / sigma)); };
    float before = 0;
    for (int i = 0; i < side; ++i) out[i] = 0;
    for (int i = first; i <= first + width && i <= side; ++i) {
      float const here = edge(i);
      if (i > first) out[i - 1] = static_cast<float>(factor) * (here - before);
      before = here;
    }
  }
};

}  // namespace gladstone::cuda
