#pragma once

#include <memory>
#include <string>

#include "render/scene/renderer.h"

namespace gladstone::cuda::inline focused_dots {

/// Renderer for focused dots on the first visible CUDA device. The check rays of a dot are traced by a warp; its ray
/// cone is integrated to truth and light by a block. All computations are in double precision.
class CudaRenderer final : public Renderer {
 public:
  CudaRenderer();
  ~CudaRenderer() override;

  std::string device() const override { return "cuda"; }
  /// Like Renderer::render(). @throws DeviceError in addition, with the sizes if device memory is exhausted
  Rendering render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources, RenderImages images,
                   RenderTheory theory) override;

 private:
  struct Uploads;  ///< data reused between successive scenes
  std::unique_ptr<Uploads> uploads_;
};

}  // namespace gladstone::cuda::inline focused_dots
