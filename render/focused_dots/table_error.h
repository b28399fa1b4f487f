#pragma once

#include "render/focused_dots/focused_dots.h"
#include "render/scene/ray_plan.h"

/// What a deflection table leaves of truth and images, and how many rays a dot take to correct it. The scene stays as
/// it is.
namespace gladstone {

/// White dots at 16 places spread over the view, the same whatever dots a scene has: no two in the same sixteenth of
/// its width or height.
DotPattern measured_places(Scene const& scene);

/// Errors of truth and images at the scene's present number of rays, measured: the dots of measured_places, each by a
/// table of its own, which is the scene's where it lies, are set beside four times 65,536 rays of another choice each;
/// the table tells where these go, and 8192 of each are traced and tell what it is off by for all. What those scatter
/// by is taken off. Levels are those of a picture of single dots (of squares side by side for a picture's). Places that
/// the table does not cover do not count.
RaysPlan measure_table_error(FocusedDots const& dots);

/// The rays that every dot takes to correct the table, and how fine table and rules are: a given number of rays, else
/// 32. Where truth is not known to be within 1e-3 px rms and images within half a grey level, table and rules twice as
/// fine; then 128 or 512 rays, as long as they take a third off the error. Dots that still scatter take up to 256
/// (DotModel). Says what it is off by then, and whether that is enough (`converged`).
RaysPlan plan_rays(FocusedDots const& dots);

/// Processor time that the deflection table of a scene's dots and the measurement of its error take [s], as
/// ray_seconds() counts it. A table takes the same rays for a hundred dots as for thousands.
double table_seconds(FocusedDots const& dots);

}  // namespace gladstone
