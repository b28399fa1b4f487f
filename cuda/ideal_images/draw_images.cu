#include <algorithm>

#include "cuda/device/launch.h"
#include "cuda/ideal_images/tile_lists.cuh"

namespace gladstone::cuda::inline ideal_images {
namespace {

constexpr int threads = 256;
constexpr int blocks = 6;  // per multiprocessor
constexpr int warp = 32;
constexpr int chunk = warp;  // particle images that a block holds at a time
constexpr int rows_per_thread = tile_size * tile_size / threads;
constexpr int margin = rows_per_thread - 1;  // number of rows by which a thread's rows extend beyond an image
constexpr unsigned int most_blocks = 65535;  // maximum extent of a grid along y

__global__ void list_kernel(DeviceParticleImages const images, GaussianSpot<double> const shape,
                            TileLists const lists) {
  std::size_t const index = blockIdx.x * std::size_t{threads} + threadIdx.x;
  if (index >= images.count) return;
  for (std::size_t frame = blockIdx.y; frame < images.frames; frame += gridDim.y) {
    enter_image(lists, shape, frame, static_cast<std::uint32_t>(index), images.images[frame * images.count + index]);
  }
}

/// Sorts the list of a tile by the rank of every entry; a list has about a hundred entries.
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

/// Particle images in the shared memory of a block. Axis 0 is x, axis 1 is y.
/// @tparam most_edges  maximum number of pixel edges of an image along one axis
template <int most_edges>
struct Chunk {
  double at[2][chunk];     ///< position [px]
  double first[2][chunk];  ///< first column (axis 0) and row (axis 1) of the footprint
  double light[chunk];
  double per_sigma[chunk];  ///< reciprocal of the standard deviation [1/px]
  int edge[2][chunk];       ///< number of the first computed edge of the footprint
  double integral[2][chunk][most_edges];
  double share[2][chunk][most_edges - 1 + 2 * margin];  ///< fraction of the light in each column and row of the
                                                        ///< footprint, with zeros on either side
  // Two copies, since the images of the next chunk are loaded while those of a chunk are drawn.
  int start[2][2][chunk];                     ///< [chunk % 2] first pixel whose share is computed, relative to the tile
  std::uint32_t reaching[2][threads / warp];  ///< [chunk % 2] bit mask of the images that overlap the rows of a warp
};

/// Number of pixels and edges along one axis that are computed for each image of a frame.
struct Extent {
  int width;  ///< pixels of a footprint
  int edges;  ///< number of computed edges: all edges of a narrow footprint; of a wide one, those in the tile
};

/// Loads the images `list`[0] to `list`[count - 1], by one warp.
/// @param turn    number of the chunk modulo 2
/// @param corner  first column and row of the tile
template <int most_edges>
__device__ void load_images(Chunk<most_edges>& held, DeviceParticleImages const& images,
                            GaussianSpot<double> const& shape, Extent const& extent, std::uint32_t const* list,
                            int count, std::size_t frame, int turn, int2 corner) {
  int const i = static_cast<int>(threadIdx.x) % warp;
  int low = tile_size;  // no row
  if (i < count) {
    ParticleImage const image = images.images[frame * images.count + list[i]];
    Footprint const print = shape.footprint(image.at);
    held.at[0][i] = image.at.x;
    held.at[1][i] = image.at.y;
    held.first[0][i] = print.column;
    held.first[1][i] = print.row;
    held.light[i] =
        images.unit ? image.light / __longlong_as_double(static_cast<long long>(images.unit[frame / 2])) : image.light;
    held.per_sigma[i] = 1.0 / image.sigma;
    bool const whole = extent.edges > extent.width;
    int const left = print.column - corner.x, top = print.row - corner.y;
    held.edge[0][i] = whole ? 0 : max(0, -left);
    held.edge[1][i] = whole ? 0 : max(0, -top);
    held.start[turn][0][i] = left + held.edge[0][i];
    held.start[turn][1][i] = low = top + held.edge[1][i];
  }
  for (int band = 0; band < threads / warp; ++band) {
    int const row = band * rows_per_thread - low;
    unsigned int const bits = __ballot_sync(0xffffffffu, row > -rows_per_thread && row < extent.edges - 1);
    if (i == band) held.reaching[turn][band] = bits;
  }
}

/// Converts a number of at least 0, exactly. A conversion instruction takes eight cycles of a warp, this sum two.
__device__ double to_double(int number) { return __hiloint2double(0x43300000, number) - 0x1p52; }

/// Position in a list of items with several elements each: elements of item 0, then of item 1, and so on.
struct Place {
  int item, element;
};

__device__ Place place_of(int index, int elements) { return {index / elements, index % elements}; }

/// Returns the position that follows `from` by `step`, which counts items and elements.
__device__ Place next_place(Place const& from, Place const& step, int elements) {
  Place const next{from.item + step.item, from.element + step.element};
  return next.element < elements ? next : Place{next.item + 1, next.element - elements};
}

/// Computes the integrals of the loaded images up to pixel edges, by the same operations as GaussianSpot::shares().
template <int most_edges>
__device__ void integrate_edges(Chunk<most_edges>& held, int count, int edges) {
  Place const step = place_of(threads, edges);
  for (Place place = place_of(threadIdx.x, edges); place.item < 2 * count; place = next_place(place, step, edges)) {
    int const axis = place.item & 1, i = place.item >> 1;
    int const edge = held.edge[axis][i] + place.element, within = edge & 7;
    double const distance =
        held.first[axis][i] + to_double(edge - within) - held.at[axis][i] + (to_double(within) - 0.5);
    held.integral[axis][i][place.element] = GaussianSpot<double>::edge_value(distance * held.per_sigma[i]);
  }
}

/// Computes the fractions of light in columns, and in rows times the light.
template <int most_edges>
__device__ void find_shares(Chunk<most_edges>& held, int count, Extent const& extent) {
  int const pixels = extent.edges - 1;
  Place const step = place_of(threads, pixels);
  for (Place place = place_of(threadIdx.x, pixels); place.item < 2 * count; place = next_place(place, step, pixels)) {
    int const axis = place.item & 1, i = place.item >> 1, k = place.element;
    double share = held.integral[axis][i][k + 1] - held.integral[axis][i][k];
    if (held.edge[axis][i] + k >= extent.width) share = 0;
    held.share[axis][i][margin + k] = axis == 0 ? share : held.light[i] * share;
  }
}

/// Draws one tile of a frame: every thread sums up some rows of a column.
template <int most_edges>
__global__ void __launch_bounds__(threads, blocks)
    draw_kernel(DeviceParticleImages const images, GaussianSpot<double> const shape, Extent const extent,
                TileLists const lists, PairLight const light, unsigned long long* brightest) {
  __shared__ Chunk<most_edges> held;
  int const tile = static_cast<int>(blockIdx.x), lane = threadIdx.x % warp, band = threadIdx.x / warp;
  int2 const corner{tile % lists.across * tile_size, tile / lists.across * tile_size};
  int const column = corner.x + lane, row = corner.y + band * rows_per_thread;
  for (int k = threadIdx.x; k < static_cast<int>(sizeof(held.share) / sizeof(double)); k += threads) {
    (&held.share[0][0][0])[k] = 0;
  }
  for (std::size_t frame = blockIdx.y; frame < images.frames; frame += gridDim.y) {
    std::size_t const tile_list = frame * lists.tiles() + blockIdx.x;
    std::uint32_t const* const list = lists.ordered + tile_list * lists.capacity;
    int const all = static_cast<int>(min(lists.count[tile_list], lists.capacity));
    auto const load = [&](int begin) {
      int const turn = begin / chunk % 2;
      if (begin < all && band == begin / chunk % (threads / warp))
        load_images(held, images, shape, extent, list + begin, min(all - begin, chunk), frame, turn, corner);
    };
    double sum[rows_per_thread] = {};
    load(0);
    __syncthreads();
    for (int begin = 0; begin < all; begin += chunk) {
      int const count = min(all - begin, chunk), turn = begin / chunk % 2;
      integrate_edges(held, count, extent.edges);
      __syncthreads();
      find_shares(held, count, extent);
      __syncthreads();
      load(begin + chunk);
      for (std::uint32_t bits = held.reaching[turn][band]; bits != 0; bits &= bits - 1) {
        int const i = __ffs(static_cast<int>(bits)) - 1;
        int const k = min(max(lane - held.start[turn][0][i], -1), extent.edges - 1);
        double const across = held.share[0][i][margin + k];
        double const* const down = held.share[1][i] + margin + band * rows_per_thread - held.start[turn][1][i];
        for (int r = 0; r < rows_per_thread; ++r) sum[r] = fma(down[r], across, sum[r]);
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
  int const width = 2 * shape.half_width() + 1;
  Extent const extent{width, std::min(width, tile_size) + 1};
  // most images are narrow, for which more blocks fit into a multiprocessor
  auto const kernel = extent.edges <= 16 ? draw_kernel<16> : draw_kernel<tile_size + 1>;
  kernel<<<dim3(tiles, grid_rows(images.frames)), threads>>>(images, shape, extent, lists, light, brightest);
  check_launch("draw_images");
}

}  // namespace gladstone::cuda::inline ideal_images
