#pragma once

#include <cstddef>
#include <cstdint>

#include "cuda/device/device_array.h"
#include "render/ideal_images/particle_image.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone::cuda::inline ideal_images {

inline constexpr int tile_size = 32;  ///< side of the square tiles of an image [px]

/// Lists of the particle images that overlap each tile of several frames, on the device.
struct TileLists {
  int columns = 0, rows = 0;         ///< size of a frame [px]
  int across = 0, down = 0;          ///< number of tiles
  std::uint32_t capacity = 0;        ///< maximum length of a list
  std::uint32_t* count = nullptr;    ///< [frame][tile] number of images, which may exceed the capacity
  std::uint32_t* entries = nullptr;  ///< [frame][tile][capacity] indices, first in any order, then ascending
  std::uint32_t* ordered = nullptr;  ///< entries in ascending order
  std::uint32_t* longest = nullptr;  ///< length of the longest list that exceeded the capacity; 0: none

  GLADSTONE_HD std::size_t tiles() const { return static_cast<std::size_t>(across) * static_cast<std::size_t>(down); }
};

/// Memory of TileLists that grows on demand.
class TileListMemory {
 public:
  /// @param capacity  initial maximum length of a list
  TileListMemory(int columns, int rows, std::size_t frames, std::uint32_t capacity);

  /// Empties all lists and returns them.
  TileLists reset();
  /// Waits for the device and returns true if every image was listed since the last call. Otherwise, increases the
  /// capacity: the lists must be filled again.
  bool complete();
  std::uint32_t capacity() const { return lists_.capacity; }

 private:
  void allocate(std::uint32_t capacity);

  std::size_t frames_;
  TileLists lists_;
  DeviceArray<std::uint32_t> count_, entries_, ordered_, longest_;
};

/// Particle images of several frames in device memory.
struct DeviceParticleImages {
  ParticleImage const* images = nullptr;  ///< particle images, [frame][count]
  std::size_t count = 0;                  ///< number of images of a frame
  std::size_t frames = 0;
  /// Photons per unit of light of each pair of frames, as bits of a double; null: the light is in these units already.
  unsigned long long const* unit = nullptr;
};

/// Light of pairs of frames in device memory.
struct PairLight {
  double* frame[2] = {};        ///< frames A and B of the first pair: [row][column]
  std::size_t pair_stride = 0;  ///< number of pixels between the same frames of successive pairs
};

/// Lists the images of every frame in the tiles that they overlap.
void list_images(DeviceParticleImages const& images, GaussianSpot<double> const& shape, TileLists const& lists);

/// Draws all listed images. Every pixel adds up its contributions in ascending order of the images, with the operations
/// of the CPU's drawing, so that the light is bitwise equal on both devices.
/// @param brightest  maximum of each pair of frames, as bits of a double, which must be initialised; null: not computed
void draw_images(DeviceParticleImages const& images, GaussianSpot<double> const& shape, TileLists const& lists,
                 PairLight const& light, unsigned long long* brightest);

}  // namespace gladstone::cuda::inline ideal_images
