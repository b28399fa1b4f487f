#pragma once

#include <optional>

#include "render/base/setup_table.h"

namespace gladstone {

enum class Focus { target, medium, distance };
enum class SpotModel { airy, gaussian, gaussian_first_zero, seed_eq8, none };

/// Table [lens] of a setup, in SI.
struct LensSetup {
  double focal_length = 0.105;  ///< [m]
  double f_number = 11.0;       ///< infinite: chief rays only
  Focus focus = Focus::target;
  double focus_distance = 0.0;  ///< from the front principal plane, for Focus::distance [m]
  SpotModel spot = SpotModel::gaussian;
};

/// Reads [lens]; prescriptions are refused by name.
LensSetup read_lens_setup(SetupTable table);

/// Image distance and magnifications of a thin lens (Raffel 2015, Exp. Fluids 56:60).
struct ImagingGeometry {
  double image_distance;  ///< z_i, lens to sensor [m]
  double magnification;   ///< M = z_i / Z_B with the actual sensor distance, also when defocused [1]
  double entrance_pupil;  ///< d_A = f / N [m]; 0 for chief rays
};

/// @param focus_distance object distance that is imaged sharply [m]; @pre greater than the focal length
ImagingGeometry thin_lens_imaging(double focal_length, double f_number, double focus_distance, double target_distance);

}  // namespace gladstone
