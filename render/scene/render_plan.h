#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "render/scene/scene.h"

namespace gladstone::inline scene {

/// Accuracy required of "auto" ray numbers: true displacements [px] and images [grey levels].
inline constexpr double truth_tolerance_px = 1e-3;
inline constexpr double image_tolerance_levels = 0.5;

/// Value of errors that were not measured (NaN).
inline constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// Integration step and the error estimate that led to it.
struct IntegrationStep {
  double step_mm = 0;            ///< step as a setup file states it [mm]
  double change_px = 0;          ///< largest change of a dot's displacement when the step is halved [px]
  std::size_t limiting_dot = 0;  ///< dot with the largest change
  double largest_shift = 0;      ///< largest deflection of the probe rays on the lens plane [m]
};

/// Camera-dependent criteria by which the general renderer chooses the number of rays of each source.
struct AdaptiveRayCriteria {
  double level = 0;         ///< light of one grey level
  double brightest_at = 0;  ///< grey levels of the brightest pixel at the chosen exposure
};

/// Error of truth and images due to the deflection table of the fast renderer, measured by measure_table_error().
struct TableError {
  double truth_px = not_measured;      ///< rms error of displacements [px]; NaN: unknown
  double image_levels = not_measured;  ///< rms error of lit pixels, worse image [levels at `bits`]; NaN: unknown
  double truth_resolution_px = 0;      ///< detection limit of truth_px: two standard errors at zero error [px]
  double image_resolution_levels = 0;  ///< detection limit of image_levels, likewise [grey levels]
  int bits = 0;                        ///< bit depth of the grey levels
  int fineness = 1;                    ///< refinement of table and rules, as RenderPlan::fineness

  /// Returns the larger of errors and detection limits in units of the tolerances; unknown errors count as 0.
  double excess() const {
    return std::fmax(std::fmax(truth_px, truth_resolution_px) / truth_tolerance_px,
                     std::fmax(image_levels, image_resolution_levels) / image_tolerance_levels);
  }
};

/// Parameters of a rendering: renderer, integration step, rays and their random numbers, and polarity. plan_rendering()
/// (planning.h) takes them from the setup and chooses those that the setup leaves open.
struct RenderPlan {
  RenderMethod method =
      RenderMethod::automatic;  ///< method of the rendering; automatic: chosen by resolve_render_method()
  double step = 0;              ///< integration step [m]
  double pupil_margin = 0;      ///< margin by which the pupil is enlarged so that no deflected ray is lost [m]
  std::uint64_t rays = 1;       ///< rays of every source; maximum number if adaptive
  /// Number of rays of every source that the setup or the caller gives; empty: chosen, see `rays`.
  std::optional<std::uint64_t> given_rays;
  std::uint64_t seed = 1;                ///< seed of the rays' random numbers
  Polarity polarity = Polarity::bright;  ///< polarity of the dots in the images
  /// Criteria of adaptive ray numbers (fast renderer: of dots at side faces); empty: all sources have `rays`.
  std::optional<AdaptiveRayCriteria> adaptive_criteria;
  int fineness = 1;               ///< refinement of the fast renderer's table and rules: 1, or 2 for steep fronts
  IntegrationStep step_estimate;  ///< error estimate by which `step` was chosen
  std::optional<TableError> table_error;  ///< error of the table by which `fineness` was chosen
};

}  // namespace gladstone::inline scene
