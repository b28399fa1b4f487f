#include "cuda/ideal_images/cuda_image_drawer.h"

#include <algorithm>

#include "cuda/device/device_light.h"
#include "cuda/ideal_images/tile_lists.h"
#include "render/base/contracts.h"

namespace gladstone::cuda::inline ideal_images {
namespace {

constexpr std::uint32_t least_capacity = 256;

}  // namespace

std::shared_ptr<RenderedLight const> CudaImageDrawer::draw(std::array<std::vector<ParticleImage>, 2> const& images,
                                                           GaussianSpot<double> const& shape, int columns, int rows) {
  std::size_t const count = images[0].size();
  GLADSTONE_EXPECTS(images[1].size() == count);
  keep_freed_device_memory();
  DeviceArray<ParticleImage> uploaded(frame_count * count, "the particle images");
  for (std::size_t frame = 0; frame < frame_count && count > 0; ++frame) {
    copy_to_device(uploaded.data() + frame * count, images[frame].data(), count * sizeof(ParticleImage));
  }
  DeviceParticleImages const all{uploaded.data(), count, frame_count, nullptr};
  auto light = std::make_shared<DeviceLight>(columns, rows);
  PairLight const drawn{{light->light(Frame::reference), light->light(Frame::flow)}, 0};
  TileListMemory memory(columns, rows, frame_count, least_capacity);
  do {
    TileLists const lists = memory.reset();
    list_images(all, shape, lists);
    draw_images(all, shape, lists, drawn, nullptr);
  } while (!memory.complete());
  return light;
}

}  // namespace gladstone::cuda::inline ideal_images
