#pragma once

#include "render/focused_dots/focused_dots.h"
#include "render/scene/ray_budget.h"
#include "render/scene/renderer.h"

/// Error of truth and images due to the deflection table, and the number of rays per dot that correct it.
namespace gladstone::inline focused_dots {

/// Measures the errors of truth and images at the plan's number of rays and fineness.
/// White dots at 16 positions spread over the view, independent of the scene's dots, are rendered with their own
/// deflection tables, identical to the scene's where they overlap, and compared with four independent samples of 16,384
/// rays. The table predicts where these land, and an eighth of them is traced to correct the prediction (control
/// variate). The scatter of the samples is subtracted. The samples are doubled, up to 65,536 rays, until errors and
/// detection limits are within 75 % of the tolerances. Grey levels refer to the image of a single dot or, for an image
/// target, of adjacent squares. Positions that the table does not cover are ignored.
TableError measure_table_error(FocusedDots const& dots);

inline constexpr std::uint64_t initial_table_rays = 32;   ///< rays per dot that correct a table of usual fineness
inline constexpr std::uint64_t refined_table_rays = 512;  ///< rays per dot that correct a refined table

/// Completes a plan that has a step with the number of rays per dot that correct the table, and the fineness of table
/// and rules.
/// If RenderPlan::given_rays is set, it is used unchanged. Otherwise it is 32 rays. If the errors exceed 1e-3 px rms in
/// the truth or half a grey level in images, table and rules are refined by a factor of two, with 512 rays. Dots with
/// large scatter use up to 256 rays (DotModel). The plan contains the remaining error of the table.
RenderPlan plan_rays_by_table(FocusedDots const& dots);

/// Estimates the processor time of a scene's deflection table and of the measurement of its error by ray_seconds() [s].
/// The table has the same number of rays for a hundred dots as for thousands.
double table_seconds(FocusedDots const& dots);

/// Estimates the processor time for rendering a scene's dots [s]: table_seconds(), the rays of every dot, and for every
/// node of its light cone the look-ups in the table and, if requested, the samples of small-angle theory (Eq. 9). No
/// clock is read: nodes and samples are counted and multiplied by times measured on the processor of
/// docs/benchmarks.md.
double dots_seconds(FocusedDots const& dots, RenderTheory theory);

}  // namespace gladstone::inline focused_dots
