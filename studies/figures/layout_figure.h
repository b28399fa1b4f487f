#pragma once

#include <vector>

#include "render/scene/setup.h"
#include "studies/design/design_point.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Geometry of a set-up in its plane through the optical axis [m]: Z along the axis from the medium's mid-plane towards
/// the camera, Y perpendicular to it.
struct OpticalLayout {
  double dots_z, lens_z, sensor_z;
  double medium_half_thickness;
  double pupil_radius;
  /// half heights of the sensor and of its images in the medium and the dots' plane
  double sensor_half, medium_half, dots_half;
  double cone_radius;  ///< radius in the medium's mid-plane, for the dot on the
                       ///< axis
  /// half thickness and half height of the laser sheet; 0 for BOS
  double sheet_half_thickness = 0, sheet_half_height = 0;
  std::vector<double> planes = {};  ///< Z of the planes of a calibration
};

OpticalLayout make_optical_layout(DesignPoint<double> const& bench);

/// Set-up from the side: target, medium, lens, sensor, light cone of the dot on the axis, field of view and
/// distances; above to scale, below with stretched heights.
Figure make_layout_figure(DesignPoint<double> const& bench);

/// Returns the paraxial geometry of any camera, with Z along its axis: from the medium's mid-plane (PIV, calibration:
/// the point of the axis at the distance Z_A) towards the camera. A laser sheet is across the axis, whatever its angle.
OpticalLayout make_camera_layout(Setup const& setup);

/// Returns the layout of make_camera_layout() as a figure, for cameras with a pose, prescription or other optical
/// elements, and for calibrations.
/// @throws DataError if the image distance or the view is infinite
Figure make_camera_layout_figure(Setup const& setup);

/// Draws the layout of make_camera_layout() for a PIV setup, with the laser sheet in the plane Z = 0.
/// @pre setup.piv
Figure make_piv_layout_figure(Setup const& setup);

}  // namespace gladstone::inline figures
