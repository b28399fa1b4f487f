#pragma once

#include <memory>
#include <string>

#include "render/scene/renderer.h"

namespace gladstone::cuda {

/// The renderer on the first visible CUDA device: TracePair over all rays, a block a dot for light and truth.
/// With render.precision = "single" rays are traced in single precision, which is a preview; sums and light are double.
class CudaRenderer final : public Renderer {
 public:
  CudaRenderer();
  ~CudaRenderer() override;

  std::string device() const override { return "cuda"; }
  /// As Renderer::render. @throws also DeviceError, out of memory with the sizes
  Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) override;

 private:
  struct Uploads;  ///< what scenes that follow each other have in common
  std::unique_ptr<Uploads> uploads_;
};

}  // namespace gladstone::cuda
