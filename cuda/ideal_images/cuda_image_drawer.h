#pragma once

#include "render/ideal_images/ideal_images.h"

namespace gladstone::cuda::inline ideal_images {

/// Draws the images of particles on the GPU, where the light remains. The light is bitwise equal to that computed on
/// the CPU.
class CudaImageDrawer final : public ImageDrawer {
 public:
  std::string device() const override { return "cuda"; }
  std::shared_ptr<RenderedLight const> draw(std::array<std::vector<ParticleImage>, 2> const& images,
                                            GaussianSpot<double> const& shape, int columns, int rows) override;
};

}  // namespace gladstone::cuda::inline ideal_images
