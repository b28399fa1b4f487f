#pragma once

#include <memory>
#include <string>

#include "render/scene/renderer.h"

namespace gladstone::cuda::inline rays {

/// General ray-tracing renderer on the first visible CUDA device, with the results of RaysRenderer: one block per
/// source, in double precision. Dot sources are aimed on the CPU.
class CudaRaysRenderer final : public Renderer {
 public:
  CudaRaysRenderer();
  ~CudaRaysRenderer() override;

  std::string device() const override { return "cuda"; }
  /// Like Renderer::render(). @throws DeviceError in addition, with the sizes if device memory is exhausted
  Rendering render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources, RenderImages images,
                   RenderTheory theory) override;
  /// Like Renderer::render_particles(); particles are aimed on the device. @throws as render()
  Rendering render_particles(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                             ParticleLight light, RenderImages images) override;

 private:
  struct Uploads;  ///< data reused between successive scenes
  std::unique_ptr<Uploads> uploads_;
};

}  // namespace gladstone::cuda::inline rays
