#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/base/image.h"
#include "render/scene/ground_truth.h"
#include "render/scene/rendered_light.h"
#include "render/scene/scene.h"

namespace gladstone {

/// Whether truth had a deflection table, and why not.
enum class TableState {
  made,
  no_medium,        ///< nothing bends rays
  no_sources,       ///< there is nothing to see
  field_too_small,  ///< it hardly reaches beyond the cones, if at all
  field_too_fine,   ///< the table would take too many rays
  by_rays,          ///< the general renderer knows none, nor does a formula
  dots_too_wide,    ///< their cones change too much from place to place of a dot
};
/// As the end of the sentence "there is no deflection table: ..."; empty where there is one.
char const* to_string(TableState state);

/// What tracing a scene gives.
struct Rendering {
  LightPair light;                                ///< empty where no images were asked for, or where they stay in place
  std::shared_ptr<RenderedLight const> in_place;  ///< with RenderImages::in_place alone
  GroundTruth truth;
  StatusCounts statuses{};
  std::int64_t rays = 0;                      ///< traced, both frames
  std::vector<std::size_t> left;              ///< sources that are another renderer's: without truth or light here
  TableState table = TableState::no_sources;  ///< whether truth had a deflection table
  RenderMethod method = RenderMethod::focused_dots;
  std::string device;  ///< that rendered it; empty: the renderer's own
};

/// Whether a rendering has images: in the host's memory, or where the renderer makes them.
enum class RenderImages { yes, no, in_place };
enum class RenderTheory { yes, no };
/// Light of particles: as they scatter the laser's, or alike into all directions, for virtual ones: a photon per
/// steradian for each that lights a square metre.
enum class ParticleLight { scattered, equal };

/// Traces scenes, on whichever device.
class Renderer {
 public:
  virtual ~Renderer() = default;
  virtual std::string device() const = 0;

  /// Traces `sources` (the scene's dots, or virtual ones) through a planned scene.
  virtual Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) = 0;

  /// Traces particles (the scene's own, or virtual ones) through a planned scene of PIV, the medium before both frames.
  /// @throws DeviceError where this device renders none
  virtual Rendering render_particles(Scene& scene, Particles const& particles, ParticleLight light,
                                     RenderImages images);
};

/// One try at tracing a scene.
struct TracingPass {
  Rendering rendering;
  double farthest_aim = 0;  ///< from the axis, that a dot was aimed at in the pupil [m]

  /// Places the dots, each with its number of rays; the rest is for the device to fill in.
  TracingPass(Scene const& scene, DotPattern const& sources);
  /// Enters a dot that the renderer chose the rays of. Dots may be entered at the same time.
  /// @param left to another renderer: not seen here
  void enter(std::size_t dot, DotTruth const& truth, std::int64_t rays, bool left);
  /// Counts the rays, and lists the dots that are left.
  Rendering finish();

 private:
  std::vector<char> left_;
};

}  // namespace gladstone
