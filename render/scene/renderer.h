#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/base/image.h"
#include "render/scene/ground_truth.h"
#include "render/scene/render_plan.h"
#include "render/scene/rendered_light.h"
#include "render/scene/scene.h"

namespace gladstone::inline scene {

/// Whether a deflection table was built for the truth, and the reason if not.
enum class TableState {
  made,             ///< a table was built
  no_medium,        ///< no medium deflects rays
  no_sources,       ///< no dots in the scene
  field_too_small,  ///< the field hardly extends beyond the light cones
  field_too_fine,   ///< the table would need too many rays
  by_rays,          ///< the dots are rendered ray by ray, without a table
  by_formula,       ///< the particles are rendered by a formula, without rays
  dots_too_wide,    ///< the light cone varies too much over the area of a dot
};
/// Returns the reason as the end of a sentence "no deflection table, since ..."; empty if there is a table.
char const* to_string(TableState state);

/// Accuracy of a rendering, measured afterwards.
struct RenderingAccuracy {
  TruthAccuracy truth;  ///< standard errors of the true displacements, relative to truth_tolerance_px
  /// Standard error of the images due to rays [levels at error_bit_depth()]: of a general rendering with an adaptive
  /// number of rays, or of the dots at side faces if a deflection table was used. NaN: not measured, or no pixel is
  /// lit.
  double image_levels = not_measured;
  std::optional<TableError> table;  ///< error of the deflection table, if the fast renderer was used
};

/// Result of rendering a scene.
struct Rendering {
  RenderPlan plan;                                ///< plan by which it was rendered, with its method
  FramePair<double> light;                        ///< light on the sensor; empty if images were not requested or remain
                                                  ///< on the device
  std::shared_ptr<RenderedLight const> in_place;  ///< light on the device; only with RenderImages::in_place
  GroundTruth truth;
  StatusCounts statuses{};
  /// Margin by which the pupil was enlarged so that no deflected ray was lost [m].
  double pupil_margin = 0;
  std::int64_t rays = 0;          ///< number of rays traced, both images together
  std::vector<std::size_t> left;  ///< fallback dots: without truth or light here, to be rendered by another renderer
  std::optional<RenderingAccuracy> accuracy;  ///< empty: not measured
  TableState table = TableState::no_sources;  ///< whether a deflection table was built
  std::string device;                         ///< device that rendered it, set by render()

  /// Moves the light of both images to `in_place`, for a device that renders in host memory.
  void store_light_in_place() {
    in_place = std::make_shared<HostLight const>(std::move(light));
    light = {};
  }
};

/// Whether images are rendered, and whether they remain in the memory of the renderer's device.
enum class RenderImages { yes, no, in_place };
enum class RenderTheory { yes, no };
/// Light of particles: scattered laser light, or an equal intensity in all directions for virtual particles (one photon
/// per steradian for a fluence of one photon per square metre).
enum class ParticleLight { scattered, equal };

/// Renders scenes on one device.
class Renderer {
 public:
  virtual ~Renderer() = default;
  virtual std::string device() const = 0;

  /// Renders `sources`: the scene's dots or virtual ones.
  virtual Rendering render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources, RenderImages images,
                           RenderTheory theory) = 0;

  /// Renders particles (the scene's own or virtual ones) of a PIV scene, with the medium in both frames.
  /// @throws DeviceError if this renderer does not support particles
  virtual Rendering render_particles(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                                     ParticleLight light, RenderImages images);
};

/// One attempt at rendering a scene. It is repeated with a larger deflection table if a dot needs one.
struct TracingPass {
  Rendering rendering;
  double largest_aim_distance = 0;  ///< largest distance of any aim point from the axis in the pupil [m]

  /// Initialises positions and ray numbers of the dots. The renderer fills in the other results.
  TracingPass(Scene const& scene, RenderPlan const& plan, DotPattern const& sources);
  /// Stores the result of a dot. Threads may store different dots concurrently.
  /// @param rays  number of rays that the renderer chose
  /// @param left  true for a fallback dot, which has no truth in this rendering
  void enter(std::size_t dot, DotTruth const& truth, std::int64_t rays, bool left);
  /// Sums up the rays and lists the fallback dots.
  Rendering finish();

 private:
  std::vector<char> left_;
};

}  // namespace gladstone::inline scene
