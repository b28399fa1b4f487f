#pragma once

#include "render/ideal_images/ideal_images.h"

namespace gladstone::cuda {

/// Draws the images of particles on the GPU; the light remains there. It is bitwise equal to that of the CPU.
class CudaImageDrawer final : public ImageDrawer {
 public:
  std::string device() const override { return "cuda"; }
  std::shared_ptr<RenderedLight const> draw(std::array<std::vector<ParticleImage>, 2> const& images,
                                            GaussianSpot<double> const& shape, int columns, int rows) override;
};

}  // namespace gladstone::cuda
