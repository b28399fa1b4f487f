#pragma once

#include "cuda/ideal_images/tile_lists.h"

namespace gladstone::cuda::inline ideal_images {

/// Enters the image with the given index into the lists of the tiles of a frame that it overlaps.
__device__ inline void enter_image(TileLists const& lists, GaussianSpot<double> const& shape, std::size_t frame,
                                   std::uint32_t index, ParticleImage const& image) {
  if (!(image.light > 0)) return;
  double const half = shape.half_width(), left = floor(image.at.x + 0.5) - half, top = floor(image.at.y + 0.5) - half;
  double const right = left + 2 * half, bottom = top + 2 * half;
  if (!(right >= 0 && bottom >= 0 && left <= lists.columns - 1 && top <= lists.rows - 1)) return;
  int const first_x = static_cast<int>(max(left, 0.0)) / tile_size,
            last_x = static_cast<int>(min(right, lists.columns - 1.0)) / tile_size,
            first_y = static_cast<int>(max(top, 0.0)) / tile_size,
            last_y = static_cast<int>(min(bottom, lists.rows - 1.0)) / tile_size;
  for (int y = first_y; y <= last_y; ++y) {
    for (int x = first_x; x <= last_x; ++x) {
      std::size_t const tile = frame * lists.tiles() + static_cast<std::size_t>(y) * lists.across + x;
      std::uint32_t const slot = atomicAdd(lists.count + tile, 1u);
      if (slot < lists.capacity) {
        lists.entries[tile * lists.capacity + slot] = index;
      } else {
        atomicMax(lists.longest, slot + 1);
      }
    }
  }
}

}  // namespace gladstone::cuda::inline ideal_images
