#include <algorithm>

#include "cuda/device/launch.h"
#include "cuda/ideal_images/tile_lists.cuh"

namespace gladstone::cuda {
namespace {

constexpr int threads = 256;
constexpr int warp = 32;
constexpr int chunk = 32;  // particle images whose shares a block holds at a time
constexpr int rows_per_thread = tile_size * tile_size / threads;
constexpr int most_edges = tile_size + 1;    // pixel edges of an image that matter to a tile, along one axis
constexpr unsigned int most_blocks = 65535;  // maximum extent of a grid along y

__global__ void list_kernel(DeviceParticleImages const images, GaussianSpot<double> const shape,
                            TileLists const lists) {
  std::size_t const index = blockIdx.x * std::size_t{threads} + threadIdx.x;
  if (index >= images.count) return;
  for (std::size_t frame = blockIdx.y; frame < images.frames; frame += gridDim.y) {
    enter_image(lists, shape, frame, static_cast<std::uint32_t>(index), images.images[frame * images.count + index]);
  }
}

/// Sorts the list of a tile by the rank of every entry: a list has about a hundred.
__global__ void order_kernel(TileLists const lists) {
  std::size_t const tile = blockIdx.x;
  std::uint32_t const count = min(lists.count[tile], lists.capacity);
  std::uint32_t const* const from = lists.entries + tile * lists.capacity;
  for (std::uint32_t i = threadIdx.x; i < count; i += blockDim.x) {
    std::uint32_t const own = from[i];
    std::uint32_t rank = 0;
    for (std::uint32_t j = 0; j < count; ++j) rank += from[j] < own ? 1 : 0;
    lists.ordered[tile * lists.capacity + rank] = own;
  }
}

/// Particle images in the shared memory of a block, restricted to its tile. Axis 0 is x, axis 1 is y.
struct Chunk {
  double at[2][chunk];  ///< position [px]
  double light[chunk];
  double per_sigma[chunk];  ///< reciprocal of the standard deviation [1/px]
  int first[2][chunk];      ///< first pixel of the footprint
  int edge[2][chunk];       ///< first edge of the footprint that is computed
  double integral[2][chunk][most_edges];
  double share[2][chunk][tile_size];  ///< fractions of light of the tile's columns; those of its rows, times light
  bool reaches[chunk][tile_size / rows_per_thread];  ///< whether the image reaches the rows of a warp
};

/// Loads the images `begin` to `begin` + chunk of a tile's list.
__device__ void load_images(Chunk& held, DeviceParticleImages const& images, GaussianSpot<double> const& shape,
                            std::uint32_t const* list, std::uint32_t count, std::size_t frame, int const (&corner)[2]) {
  for (std::uint32_t i = threadIdx.x; i < count; i += threads) {
    ParticleImage const image = images.images[frame * images.count + list[i]];
    Footprint const print = shape.footprint(image.at);
    held.at[0][i] = image.at.x;
    held.at[1][i] = image.at.y;
    held.light[i] =
        images.unit ? image.light / __longlong_as_double(static_cast<long long>(images.unit[frame / 2])) : image.light;
    held.per_sigma[i] = 1.0 / image.sigma;
    held.first[0][i] = print.column;
    held.first[1][i] = print.row;
    for (int axis = 0; axis < 2; ++axis) {
      // A narrow footprint is computed as a whole, of a wide one the part in the tile.
      held.edge[axis][i] = print.width < most_edges ? 0 : max(0, corner[axis] - held.first[axis][i]);
    }
  }
}

/// Returns GaussianSpot::edge_integral() of a held image, by the same operations.
__device__ double edge_integral(Chunk const& held, int axis, int i, int edge) {
  int const within = edge % 8;
  double const distance =
      static_cast<double>(held.first[axis][i] + (edge - within)) - held.at[axis][i] + (within - 0.5);
  return GaussianSpot<double>::edge_value(distance * held.per_sigma[i]);
}

/// Computes the integrals of the images up to pixel edges. A group of 16 or 32 threads takes one axis of one image.
/// @param edges  number of edges per image and axis
__device__ void integrate_edges(Chunk& held, int count, int edges, int const (&corner)[2]) {
  int const group = edges <= warp / 2 ? warp / 2 : warp;
  int const member = static_cast<int>(threadIdx.x) & (group - 1);
  for (int item = static_cast<int>(threadIdx.x) / group; item < 2 * count; item += threads / group) {
    int const axis = item & 1, i = item >> 1;
    for (int k = member; k < edges; k += group) {
      int const edge = held.edge[axis][i] + k, pixel = held.first[axis][i] + edge - corner[axis];
      if (pixel < 0 || pixel > tile_size) continue;  // not an edge of a pixel in the tile
      held.integral[axis][i][k] = edge_integral(held, axis, i, edge);
    }
  }
}

/// Computes the fractions of light in the columns and rows of the tile, and which warps have some. A warp takes one
/// axis of one image.
__device__ void find_shares(Chunk& held, int count, int edges, int width, int const (&corner)[2]) {
  int const pixel = static_cast<int>(threadIdx.x) % tile_size;
  for (int item = static_cast<int>(threadIdx.x) / tile_size; item < 2 * count; item += threads / tile_size) {
    int const axis = item & 1, i = item >> 1;
    int const within = corner[axis] + pixel - held.first[axis][i], k = within - held.edge[axis][i];
    double share = 0;
    if (within >= 0 && within < width && k >= 0 && k + 1 < edges) {
      share = held.integral[axis][i][k + 1] - held.integral[axis][i][k];
    }
    held.share[axis][i][pixel] = axis == 0 ? share : held.light[i] * share;
    if (axis == 1 && pixel % rows_per_thread == 0) {
      held.reaches[i][pixel / rows_per_thread] = within + rows_per_thread > 0 && within < width;
    }
  }
}

/// Draws one tile of a frame: every thread sums up some rows of a column.
__global__ void __launch_bounds__(threads)
    draw_kernel(DeviceParticleImages const images, GaussianSpot<double> const shape, TileLists const lists,
                PairLight const light, unsigned long long* brightest) {
  __shared__ Chunk held;
  int const tile = static_cast<int>(blockIdx.x), width = 2 * shape.half_width() + 1;
  int const edges = width < most_edges ? width + 1 : most_edges;
  int const corner[2] = {tile % lists.across * tile_size, tile / lists.across * tile_size};
  int const lane = threadIdx.x % warp, band = threadIdx.x / warp, column = corner[0] + lane,
            row = corner[1] + band * rows_per_thread;
  for (std::size_t frame = blockIdx.y; frame < images.frames; frame += gridDim.y) {
    std::size_t const list = frame * lists.tiles() + blockIdx.x;
    std::uint32_t const all = min(lists.count[list], lists.capacity);
    double sum[rows_per_thread] = {};
    for (std::uint32_t begin = 0; begin < all; begin += chunk) {
      int const count = static_cast<int>(min(all - begin, std::uint32_t{chunk}));
      load_images(held, images, shape, lists.ordered + list * lists.capacity + begin, count, frame, corner);
      __syncthreads();
      integrate_edges(held, count, edges, corner);
      __syncthreads();
      find_shares(held, count, edges, width, corner);
      __syncthreads();
      for (int i = 0; i < count; ++i) {
        if (!held.reaches[i][band]) continue;
        double const across = held.share[0][i][lane];
        for (int k = 0; k < rows_per_thread; ++k) {
          sum[k] = fma(held.share[1][i][band * rows_per_thread + k], across, sum[k]);
        }
      }
      __syncthreads();
    }
    double* const pixels = light.frame[frame % 2] + frame / 2 * light.pair_stride;
    double most = 0;
    for (int k = 0; k < rows_per_thread; ++k) {
      if (column >= lists.columns || row + k >= lists.rows) continue;
      pixels[static_cast<std::size_t>(row + k) * lists.columns + column] = sum[k];
      most = max(most, sum[k]);
    }
    if (!brightest) continue;
    for (int offset = warp / 2; offset > 0; offset /= 2) most = max(most, __shfl_xor_sync(0xffffffffu, most, offset));
    if (lane == 0) atomicMax(brightest + frame / 2, static_cast<unsigned long long>(__double_as_longlong(most)));
  }
}

unsigned int grid_rows(std::size_t frames) {
  return static_cast<unsigned int>(std::min<std::size_t>(frames, most_blocks));
}

}  // namespace

void list_images(DeviceParticleImages const& images, GaussianSpot<double> const& shape, TileLists const& lists) {
  if (images.count == 0) return;
  dim3 const grid(static_cast<unsigned int>((images.count + threads - 1) / threads), grid_rows(images.frames));
  list_kernel<<<grid, threads>>>(images, shape, lists);
  check_launch("list_images");
}

void draw_images(DeviceParticleImages const& images, GaussianSpot<double> const& shape, TileLists const& lists,
                 PairLight const& light, unsigned long long* brightest) {
  auto const tiles = static_cast<unsigned int>(lists.tiles());
  order_kernel<<<static_cast<unsigned int>(lists.tiles() * images.frames), 64>>>(lists);
  check_launch("order_images");
  draw_kernel<<<dim3(tiles, grid_rows(images.frames)), threads>>>(images, shape, lists, light, brightest);
  check_launch("draw_images");
}

}  // namespace gladstone::cuda
