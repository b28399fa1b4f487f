#include "cuda/ideal_images/tile_lists.h"

#include "render/base/contracts.h"

namespace gladstone::cuda::inline ideal_images {

TileListMemory::TileListMemory(int columns, int rows, std::size_t frames, std::uint32_t capacity) : frames_(frames) {
  GLADSTONE_EXPECTS(columns > 0 && rows > 0 && frames > 0 && capacity > 0);
  lists_.columns = columns;
  lists_.rows = rows;
  lists_.across = (columns + tile_size - 1) / tile_size;
  lists_.down = (rows + tile_size - 1) / tile_size;
  count_ = DeviceArray<std::uint32_t>(frames * lists_.tiles(), "the lists of particle images");
  longest_ = DeviceArray<std::uint32_t>(1, "the lists of particle images");
  lists_.count = count_.data();
  lists_.longest = longest_.data();
  longest_.zero();
  allocate(capacity);
}

void TileListMemory::allocate(std::uint32_t capacity) {
  entries_ = {};
  ordered_ = {};
  std::size_t const entries = frames_ * lists_.tiles() * capacity;
  entries_ = DeviceArray<std::uint32_t>(entries, "the lists of particle images");
  ordered_ = DeviceArray<std::uint32_t>(entries, "the lists of particle images");
  lists_.capacity = capacity;
  lists_.entries = entries_.data();
  lists_.ordered = ordered_.data();
}

TileLists TileListMemory::reset() {
  count_.zero();
  return lists_;
}

bool TileListMemory::complete() {
  std::uint32_t longest = 0;
  longest_.download(&longest, 1);
  if (longest == 0) return true;
  longest_.zero();
  allocate(longest + longest / 4);
  return false;
}

}  // namespace gladstone::cuda::inline ideal_images
