#pragma once

#include "render/scene/renderer.h"

/// Measurements compared in the rows of validate.cpp; units are given in the names or comments.
namespace gladstone::inline oracles::oracle {

// Oracles of the ray equation, defined in medium_oracles.cpp.
double linear_index_x(Renderer&);  ///< x of a ray after one step of t = 5
double rod_position_mm(Renderer&);
double rod_error_ratio(Renderer&);  ///< ratio of the errors before and after halving the step
/// distance of the focus from the pole, maximum over several ray heights [radii]
double luneburg_focus(Renderer&);
double luneburg_optical_path(Renderer&);  ///< optical path from the plane z = -1 to the focus [radii]
double fish_eye_miss(Renderer&);          ///< distance of the ray from the antipode
double slab_matched_m(Renderer&);
double slab_refracting_m(Renderer&);
double steep_slab_refracting_m(Renderer&);
double eikonal_drift(Renderer&);            ///< | |T| - n | where a skew ray exits the rod
double reversal_miss_mm(Renderer&);         ///< distance from the start of a ray to the end of the reversed ray
double spline_polynomial_error(Renderer&);  ///< largest relative error of value and slopes of a bicubic, up to the edge
double plume_deflection(Renderer&);         ///< deflection at x = a / sqrt 2, relative to dn / n0
double tilted_shock_slope(Renderer&);       ///< slope of a ray relative to the exact one by Snell's law, dn tan(phi)
double shock_ratio_mach_2(Renderer&);
double ciddor_532(Renderer&);
double merzkirch_532(Renderer&);

// Oracles of camera and renderer with the setup of Table 1, defined in camera_oracles.cpp.
double magnification(Renderer&);
double image_distance_m(Renderer&);
double cone_diameter_m(Renderer&);
double spot_diameter_px(Renderer&);
double spot_energy(Renderer&);
double off_axis_column_px(Renderer&);  ///< column of a dot 10 mm off axis
double uniform_density_px(Renderer&);  ///< largest displacement in a uniform dense field
double sensitivity_px(Renderer&);      ///< displacement per density gradient [px per kg/m^4]
double cone_average_4mm(Renderer&);    ///< displacement in a density wave relative to Eq. 9
double cone_average_8mm(Renderer&);
double ray_spread_8mm(Renderer&);  ///< standard deviation of the displacements of a dot's rays relative to Eq. 9

}  // namespace gladstone::inline oracles::oracle
