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

/// Integration step and the error estimate that led to it.
struct IntegrationStep {
  double step_mm = 0;            ///< step as a setup file states it [mm]
  double change_px = 0;          ///< largest change of a dot's displacement when the step is halved [px]
  std::size_t limiting_dot = 0;  ///< dot with the largest change
  double largest_shift = 0;      ///< largest deflection of the probe rays on the lens plane [m]
};

/// Accuracy required of "auto" ray numbers: true displacements [px] and images [grey levels].
inline constexpr double truth_tolerance_px = 1e-3;
inline constexpr double image_tolerance_levels = 0.5;

/// Maximum processor time for the rays of one source with an adaptive ray number [s]: one minute for the 5000 dots of
/// 512 x 512 px. The limit applies per source, so that the ray number of a source does not depend on the others. The
/// resulting maximum is between 1024 and 65,536 rays.
inline constexpr double source_budget_s = 0.012;

/// Value of errors that were not measured (NaN).
inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// Returns the larger of the two errors in units of their tolerances; errors that were not measured count as 0.
inline double error_to_tolerance_ratio(double truth_px, double image_levels) {
  return std::fmax(std::fmax(0.0, truth_px / truth_tolerance_px), image_levels / image_tolerance_levels);
}

/// Measured errors of dots at side faces of the medium (side_faces.h), which are rendered by rays alone; cf. RayBudget.
struct SideFaceErrors {
  std::size_t dots = 0;    ///< number of such dots
  std::uint64_t rays = 0;  ///< rays per dot
  double truth_error_px = not_measured, image_error_levels = not_measured;
  double rays_wanted = not_measured;

  double excess() const { return error_to_tolerance_ratio(truth_error_px, image_error_levels); }
};

/// Number of rays per source and the measured errors that led to it.
struct RayBudget {
  RenderMethod method = RenderMethod::automatic;  ///< renderer chosen by "auto" from the errors, or the configured one
  std::uint64_t rays = 0;  ///< rays per source; if adaptive, the largest number among the sampled sources
  std::uint64_t most = 0;  ///< maximum number of rays per source if adaptive; 0: all sources have `rays`
  std::optional<AdaptiveRayCriteria> adaptive_criteria;  ///< criteria of the adaptive ray number; empty: not adaptive
  std::uint64_t rays_at_side_faces = 0;  ///< maximum number of rays of dots at side faces (side_faces.h); 0: as others
  int fineness = 1;                      ///< refinement of table and rules, as Scene::fineness
  double truth_error_px = not_measured;  ///< rms error of displacements [px]; NaN: not measured, or no ray passed
  double image_error_levels = not_measured;  ///< rms error of lit pixels, worse image [levels at `bits`]; NaN: unknown
  double truth_resolution_px = 0;      ///< detection limit of truth_error_px: two standard errors at zero error [px]
  double image_resolution_levels = 0;  ///< detection limit of image_error_levels, likewise [grey levels]
  int bits = 0;                        ///< bit depth of the grey levels
  bool extrapolated = false;           ///< the errors were measured with up to 4096 rays and extrapolated
  bool converged = true;               ///< false: the errors exceed the tolerances
  double rays_wanted = not_measured;   ///< estimated rays per source that meet the tolerances; NaN: unknown, or no
                                       ///< number of rays is sufficient
  double seconds = not_measured;       ///< estimated processor time of a rendering by ray_seconds() [s]

  std::optional<SideFaceErrors> side_faces;  ///< for the fast renderer; empty: no dot in view is at a side face

  /// Returns the larger of errors and resolutions in units of the tolerances.
  double excess() const {
    return error_to_tolerance_ratio(std::fmax(truth_error_px, truth_resolution_px),
                                    std::fmax(image_error_levels, image_resolution_levels));
  }
};

/// Estimates the processor time per ray of one source, traced in both images [s].
/// Integration steps, lit pixels and lens surfaces are counted and multiplied by times measured on the processor of
/// docs/benchmarks.md. No clock is read, so the estimate, and hence the ray number, is the same on any machine.
double ray_seconds(Scene const& scene);
/// Estimates the processor time for one ray of every source [s].
double rays_seconds(Scene const& scene);

/// Estimates the processor time of small-angle theory (Eq. 9) along one straight ray through the medium [s].
double theory_ray_seconds(Scene const& scene);

/// Returns the maximum number of rays per source for adaptive ray numbers: a power of two from 1024 to 65,536.
std::uint64_t max_rays_per_source(Scene const& scene);

/// Displacements of dots by a common set of rays, and their largest deflections on the lens plane.
struct Probe {
  std::vector<Vec2d> displacement_px;
  std::vector<double> shift;  ///< largest deflection of each dot's rays on the lens plane [m]

  double largest_shift() const;
};
/// Returns the difference of each dot's displacement between two probes [px].
std::vector<double> changes(Probe const& coarse, Probe const& fine);

/// Probes by which the accuracy of a step is measured.
struct StepProbes {
  std::vector<std::size_t> dots;  ///< dots that `at` probes
  double largest_shift = 0;       ///< largest deflection of rays of other dots on the lens plane [m]
  /// traces the probes with a given step [m]
  std::function<Probe(double step)> at;
};
/// Maximum number of dots that are probed with all rays. For larger targets, those with the largest values are chosen.
inline constexpr std::size_t probed_dots = 256;
std::vector<std::size_t> largest_of(std::vector<double> const& value);

/// Chooses the integration step such that halving it changes no dot's displacement by more than 1e-4 px.
/// The search starts at medium.coarsest_step and halves it up to 12 times. A step given in the setup is used unchanged,
/// and its error is measured.
/// @param prepare  creates the probes for the first step and passes them to its second argument, which runs the search
IntegrationStep choose_step(
    Scene const& scene, std::function<void(double step, std::function<void(StepProbes const&)> const&)> const& prepare);

/// Returns the scene with the step and the pupil margin of a plan.
Scene with_step(Scene scene, IntegrationStep const& plan);

/// Returns the plan of a setup with a given number of rays; nullopt for "auto".
std::optional<RayBudget> configured_ray_budget(Setup const& setup);

/// Returns the scene with the ray numbers of a plan, the refinement of the fast renderer, and the method if the plan
/// chose one.
Scene with_rays(Scene scene, RayBudget const& plan);

}  // namespace gladstone
