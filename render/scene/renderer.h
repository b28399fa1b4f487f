#pragma once

#include <functional>
#include <memory>
#include <string>

#include "render/base/image.h"
#include "render/scene/deflection_map.h"
#include "render/scene/ground_truth.h"
#include "render/scene/scene.h"

namespace gladstone {

/// Two frames as light per pixel, in fully lit pixels on the axis; noise-free, not rounded.
struct LightPair {
  Image<double> reference;
  Image<double> flow;
};

/// What tracing a scene gives.
struct Rendering {
  LightPair light;  ///< empty where no images were asked for
  GroundTruth truth;
  StatusCounts statuses{};
  std::int64_t rays = 0;  ///< traced, both frames
};

enum class RenderImages { yes, no };
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

/// Traces a scene as often as it takes for the pupil to be wide enough for what the medium bends, and gives the images
/// their polarity: what render() is on every device.
Rendering render_with_margin(Scene& scene, RenderImages images, std::function<TracingPass()> const& trace);

/// Turns the light that bright dots send into what the target's polarity says: dark dots are taken from a white target.
void apply_polarity(Scene const& scene, LightPair& light);

/// A white target seen by the camera: light per pixel, cos^4 of the angle to the axis. What dark dots are taken from;
/// the flow does not change it, since radiance is conserved along rays.
Image<double> white_light(Scene const& scene);

}  // namespace gladstone
