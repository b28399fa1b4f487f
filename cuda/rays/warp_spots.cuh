#pragma once

#include "cuda/rays/add_psf.cuh"
#include "cuda/rays/trace_particles.h"

namespace gladstone::cuda::inline rays {

/// Accumulates the Gaussian PSFs of a warp's rays, which may belong to several particles. Each lane computes the column
/// and row shares of its ray; then all lanes sum over a particle's rays in the pixels of its square, one particle after
/// the other. The shares have an error of 1e-6, a fifteenth of a grey level at 16 bits.
class WarpSpots {
 public:
  /// Returns the shared memory of a warp [bytes].
  GLADSTONE_HD static std::size_t bytes(int most_side) {
    return static_cast<std::size_t>(2 * warp_size * pitch_of(most_side)) * sizeof(float);
  }
  __device__ WarpSpots(unsigned char* memory, int most_side)
      : pitch_(pitch_of(most_side)), columns_(reinterpret_cast<float*>(memory)), rows_(columns_ + warp_size * pitch_) {}

  /// Adds the PSFs of all lanes. Must be called by all lanes of the warp.
  /// @param square  square of pixels in which the light of the lane's particle is accumulated
  /// @param units  light of the ray; 0: none
  /// @param lanes  number of adjacent lanes per particle
  /// @return false if the ray's light is outside its square
  __device__ bool accumulate_light(SpotView const& spot, LightSquare const& square, Vec2d p, double units, int lanes,
                                   int frame, DeviceImages const& images) const {
    int const lane = threadIdx.x % warp_size;
    int const half = spot.half_width(), width = 2 * half + 1;
    bool taken = false;
    int column = 0, row = 0;
    if (units != 0 && fabs(p.x) < 1e7 && fabs(p.y) < 1e7) {
      column = static_cast<int>(floor(p.x + 0.5)) - half - square.left;
      row = static_cast<int>(floor(p.y + 0.5)) - half - square.top;
      taken = column >= 0 && row >= 0 && column + width <= square.side && row + width <= square.side;
    }
    __syncwarp();  // all lanes have finished the previous rays
    float *const of_columns = columns_ + lane * pitch_, *const of_rows = rows_ + lane * pitch_;
    for (int i = 0; i < square.side; ++i) of_columns[i] = of_rows[i] = 0;
    if (taken) {
      shares(spot.gaussian.sigma, p.x - square.left, column, width, 1, of_columns);
      shares(spot.gaussian.sigma, p.y - square.top, row, width, units, of_rows);
    }
    unsigned int const any = __ballot_sync(whole_warp, taken);
    __syncwarp();
    unsigned int const of_particle = lanes < warp_size ? (1u << lanes) - 1 : whole_warp;
    for (int first = 0; first < warp_size; first += lanes) {
      if ((any & (of_particle << first)) == 0) continue;
      int const side = __shfl_sync(whole_warp, square.side, first), left = __shfl_sync(whole_warp, square.left, first);
      int const top = __shfl_sync(whole_warp, square.top, first), to = __shfl_sync(whole_warp, frame, first);
      for (int k = lane; k < side * side; k += warp_size) {
        int const x = k % side, y = k / side;
        float sum = 0;
        for (int ray = first; ray < first + lanes; ++ray) sum += columns_[ray * pitch_ + x] * rows_[ray * pitch_ + y];
        if (sum != 0)
          add_light(images, static_cast<Frame>(to), left + x, top + y, whole_units(static_cast<double>(sum)));
      }
    }
    return taken || units == 0;
  }

 private:
  /// Odd, so that adjacent lanes write to different banks.
  GLADSTONE_HD static int pitch_of(int most_side) { return most_side | 1; }

  /// Computes the shares of `width` pixels, from `first` on, of light centred at p, multiplied by a factor.
  __device__ static void shares(double sigma, double p, int first, int width, double factor, float* out) {
    auto const edge = [&](int i) { return GaussianSpot<float>::edge_value(static_cast<float>((i - 0.5 - p) / sigma)); };
    float before = edge(first);
    for (int i = first; i < first + width; ++i) {
      float const here = edge(i + 1);
      out[i] = static_cast<float>(factor) * (here - before);
      before = here;
    }
  }

  int pitch_;
  float *columns_, *rows_;  ///< [lane][pixel]: fractions of a ray's light in the columns, and those in the rows
                            ///< multiplied by the light
};

}  // namespace gladstone::cuda::inline rays
