#pragma once

#include <optional>

#include "render/optics/lens.h"

namespace gladstone::inline optics {

/// Distance ahead of the first vertex at which rays parallel to the axis begin [m].
inline constexpr double start_of_parallel_rays = 1;

/// Determines the radius of the stop of a lens whose surfaces are placed, and applies it to the stop surface.
/// @throws DataError if neither options nor prescription determine it, or if no light passes the stop
void open_stop(Lens& lens, LensOptions const& options);

/// Returns the paraxial radius of the stop by the prescription's own aperture [m]; nullopt if it is not defined.
std::optional<double> prescribed_stop_radius(Lens lens, LensOptions options);

/// Warns if an f-number opens the stop wider than the prescription does, and reports the widest beam that the edges
/// pass.
/// @param own_radius       paraxial radius of the stop by the prescription [m]
/// @param object_distance  from the first vertex [m]
void note_wide_stop(Lens& lens, double f_number, double own_radius, double object_distance);

/// Removes central obscurations without outer radius that are larger than the axial beam, and would block all of it.
void open_rings(Lens& lens);

}  // namespace gladstone::inline optics
