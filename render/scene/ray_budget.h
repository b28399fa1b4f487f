#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "render/scene/scene.h"

namespace gladstone {

/// Integration step and the error estimate by which it was chosen.
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

/// Error of truth and images due to the deflection table of the fast renderer, measured by measure_table_error().
struct TableError {
  double truth_px = not_measured;      ///< rms error of displacements [px]; NaN: unknown
  double image_levels = not_measured;  ///< rms error of lit pixels, worse image [levels at `bits`]; NaN: unknown
  double truth_resolution_px = 0;      ///< detection limit of truth_px: two standard errors at zero error [px]
  /// detection limit of image_levels: two standard errors at zero error [grey levels]
  double image_resolution_levels = 0;
  int bits = 0;      ///< bit depth of the grey levels
  int fineness = 1;  ///< refinement of table and rules, as Scene::fineness

  /// Returns the larger of errors and detection limits in units of the tolerances; unknown errors count as 0.
  double excess() const {
    return std::fmax(std::fmax(truth_px, truth_resolution_px) / truth_tolerance_px,
                     std::fmax(image_levels, image_resolution_levels) / image_tolerance_levels);
  }
};

/// Renderer and number of rays per source.
struct RayBudget {
  RenderMethod method = RenderMethod::automatic;  ///< renderer chosen by "auto", or the configured one
  /// Rays per source; general renderer with "auto": maximum, each source takes what it requires.
  std::uint64_t rays = 1;
  /// Criteria of adaptive ray numbers (fast renderer: of dots at side faces); empty: all sources have `rays`.
  std::optional<AdaptiveRayCriteria> adaptive_criteria;
  int fineness = 1;                       ///< refinement of table and rules, as Scene::fineness
  std::optional<TableError> table_error;  ///< error of the table by which `fineness` was chosen
};

/// Returns the bit depth in which image errors are stated: the camera's, 12 at most.
int error_bit_depth(CameraSetup const& camera);
/// Returns the light of one grey level at error_bit_depth().
/// @param exposure_e  electrons per unit of light
double light_per_level(CameraSetup const& camera, double exposure_e);

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

/// Returns a copy of the scene with an integration step and the pupil margin that results from its probe rays.
Scene with_step(Scene scene, IntegrationStep const& plan);

/// Returns a copy of the scene with the ray numbers of a budget, the refinement of the fast renderer, and the method if
/// the budget chose one.
Scene with_rays(Scene scene, RayBudget const& budget);

}  // namespace gladstone
