#pragma once

#include <functional>
#include <memory>
#include <string>

#include "render/base/image.h"
#include "render/focused_dots/deflection_map.h"
#include "render/scene/ground_truth.h"
#include "render/scene/kept_light.h"
#include "render/scene/scene.h"

namespace gladstone {

/// What tracing a scene gives.
struct Rendering {
  LightPair light;                        ///< empty where no images were asked for, or where they are kept
  std::shared_ptr<KeptLight const> kept;  ///< with RenderImages::kept alone
  GroundTruth truth;
  StatusCounts statuses{};
  std::int64_t rays = 0;                      ///< traced, both frames
  TableState table = TableState::no_sources;  ///< whether truth had a deflection table
  RenderMethod method = RenderMethod::focused_dots;
  std::string device;  ///< that rendered it; empty: the renderer's own
};

/// Whether a rendering has images: in the host's memory, or kept where the renderer makes them.
enum class RenderImages { yes, no, kept };
enum class RenderTheory { yes, no };

/// Traces scenes, on whichever device.
class Renderer {
 public:
  virtual ~Renderer() = default;
  virtual std::string device() const = 0;

  /// Traces `sources` (the scene's dots, or virtual ones) through a planned scene. Grows scene.pupil_margin and starts
  /// again should a ray turn out to be bent further than planned.
  virtual Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) = 0;
};

/// The renderer on the CPU's cores.
class CpuRenderer : public Renderer {
 public:
  std::string device() const override { return "cpu"; }
  Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) override;

 private:
  KeptDeflections<DeflectionMap> deflections_;
};

/// One try at tracing a scene.
struct TracingPass {
  Rendering rendering;
  double largest_bend = 0;  ///< furthest that the medium moved a ray on the lens plane [m]

  /// Counts the rays and places the dots; the rest is for the device to fill in.
  TracingPass(Scene const& scene, DotPattern const& sources);
};

/// Traces a scene as often as it takes for the pupil to be wide enough for what the medium bends: what render() is on
/// every device.
Rendering render_with_margin(Scene& scene, std::function<TracingPass()> const& trace);

/// A white target seen by the camera: light per pixel, cos^4 of the angle to the axis. What dark dots are taken from;
/// the flow does not change it, since radiance is conserved along rays.
Image<double> white_light(Scene const& scene);

}  // namespace gladstone
