#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "render/scene/scene.h"

namespace gladstone {

/// How the step was chosen.
struct StepPlan {
  double step_mm = 0;    ///< [mm], the number that a setup file holds
  double change_px = 0;  ///< largest change of a dot's displacement when the step is halved
  std::size_t limiting_dot = 0;
  double largest_shift = 0;  ///< on the lens plane, of the probing rays [m]
};

/// What "auto" asks of truth [px] and of images [grey levels].
inline constexpr double truth_tolerance_px = 1e-3;
inline constexpr double image_tolerance_levels = 0.5;

/// Processor time that the rays of a source may take where they are chosen by its need [s]: a minute for the 5000 dots
/// of 512 x 512 px. Of a source and not of a scene, so that none has the fewer rays for the others. 1024 rays are
/// always allowed, 65,536 at most.
inline constexpr double source_budget_s = 0.012;

/// What nothing tells of a plan.
inline constexpr double not_told = std::numeric_limits<double>::quiet_NaN();

/// Errors over their tolerances, whichever is larger; 0 for one that is not known.
inline double excess_of(double truth_px, double image_levels) {
  return std::fmax(std::fmax(0.0, truth_px / truth_tolerance_px), image_levels / image_tolerance_levels);
}

/// What rays alone leave of the dots at side faces (side_faces.h), as RaysPlan says it of all.
struct SideFaceErrors {
  std::size_t dots = 0;    ///< there are
  std::uint64_t rays = 0;  ///< of each
  double truth_error_px = not_told, image_error_levels = not_told;
  double rays_wanted = not_told;

  double excess() const { return excess_of(truth_error_px, image_error_levels); }
};

/// How the number of rays was chosen.
struct RaysPlan {
  RenderMethod method = RenderMethod::automatic;  ///< that "auto" chose by these errors; else what the scene says
  std::uint64_t rays = 0;                ///< of every source; where each takes what it needs, the most of the sample's
  std::uint64_t most = 0;                ///< that a source may take of what it needs; 0: all have `rays`
  std::optional<RaysByNeed> by_need;     ///< of the sources that take what they need
  std::uint64_t rays_at_side_faces = 0;  ///< of dots there (side_faces.h), the most of one; 0: as many
  int fineness = 1;                      ///< as the scene's
  double truth_error_px = not_told;      ///< of displacements, rms over dots, components and scramblings; NaN: none was
                                         ///< measured, or of no dot a ray got through
  double image_error_levels = not_told;  ///< rms over lit pixels of the worse frame, in grey levels of `bits`; NaN:
                                         ///< none was measured, or none was lit
  double truth_resolution_px =
      0;  ///< two standard errors where the table leaves nothing: a smaller one is not told from none
  double image_resolution_levels = 0;  ///< likewise
  int bits = 0;
  bool extrapolated = false;  ///< the errors were measured up to 4096 rays and extrapolated from there
  bool converged = true;      ///< false: the errors are larger than is asked
  double rays_wanted =
      not_told;               ///< of a source, that would do, as far as can be told; NaN: nothing tells, or none would
  double seconds = not_told;  ///< of processor time that a rendering will take, by ray_seconds()

  std::optional<SideFaceErrors> side_faces;  ///< of the fast renderer; none: no dot in view lies there

  /// Of the errors, or of what could be told of them where that is larger.
  double excess() const {
    return excess_of(std::fmax(truth_error_px, truth_resolution_px),
                     std::fmax(image_error_levels, image_resolution_levels));
  }
};

/// Processor time that a rendering of the scene takes for one ray of a source in both frames [s]: a count of steps and
/// of pixels lit times what each took on the processor of docs/benchmarks.md. Not a clock's, so that a plan is the same
/// anywhere.
double ray_seconds(Scene const& scene);
/// The same for one ray of every source.
double rays_seconds(Scene const& scene);

/// The most rays that a source may take of what it needs: a power of two.
std::uint64_t most_rays_of_source(Scene const& scene);

/// Displacements of dots by shared rays, and how far the lens plane sees them bent at most.
struct Probe {
  std::vector<Vec2d> displacement_px;
  std::vector<double> shift;  ///< [m]

  double largest_shift() const;
};
/// How far each dot moves from one probe to the other [px].
std::vector<double> changes(Probe const& coarse, Probe const& fine);

/// What tells how good a step is.
struct StepProbes {
  std::vector<std::size_t> dots;  ///< that are probed
  double largest_shift = 0;       ///< of rays beside these [m]
  std::function<Probe(double step)> at;
};
/// Dots that are probed by all rays, of a target with more: those with the largest values.
inline constexpr std::size_t probed_dots = 256;
std::vector<std::size_t> largest_of(std::vector<double> const& value);

/// Chooses the step such that halving it changes no dot's displacement by 1e-4 px; starts from medium.coarsest_step,
/// never above it. With a step in the setup that one is used, and measured likewise. use_step() is left to the caller.
/// @param prepare makes probes for the first step and hands them to the search
StepPlan choose_step(Scene const& scene,
                     std::function<void(double step, std::function<void(StepProbes const&)> const&)> const& prepare);

/// Sets scene.step and scene.pupil_margin.
void use_step(Scene& scene, StepPlan const& plan);

/// The plan of a setup that says how many rays; nothing where that is to be chosen.
std::optional<RaysPlan> given_rays(Setup const& setup);

/// Sets scene.rays_per_dot, by_need and rays_at_side_faces.
void use_rays(Scene& scene, RaysPlan const& plan);

}  // namespace gladstone
