#pragma once

#include <memory>
#include <string>

#include "render/scene/renderer.h"

namespace gladstone::cuda {

/// The general renderer on the first visible CUDA device: what RaysRenderer gives, a block a source, in double. Where a
/// source's rays go is found on the CPU's cores.
class CudaRaysRenderer final : public Renderer {
 public:
  CudaRaysRenderer();
  ~CudaRaysRenderer() override;

  std::string device() const override { return "cuda"; }
  /// As Renderer::render. @throws also DeviceError, out of memory with the sizes
  Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) override;
  /// As Renderer::render_particles; which rays fill the stop is found on the device. @throws as render
  Rendering render_particles(Scene& scene, Particles const& particles, ParticleLight light,
                             RenderImages images) override;

 private:
  struct Uploads;  ///< what scenes that follow each other have in common
  std::unique_ptr<Uploads> uploads_;
};

}  // namespace gladstone::cuda
