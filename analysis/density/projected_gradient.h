#pragma once

#include <cstddef>

#include "analysis/density/gradient_map.h"
#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline density {

/// Quantities of a BOS set-up that determine the ratio of displacement to projected density gradient.
struct ProjectionOptics {
  double magnification = 0.0;  ///< magnification M of the dot plane [1]
  /// Z_A, distance from the front principal plane of the lens to the medium's mid-plane [m].
  double lens_distance = 0.0;
  double target_distance = 0.0;  ///< Z_D, distance from the medium's mid-plane to the dot plane [m]
  double pixel_pitch = 0.0;      ///< pixel pitch p of the sensor [m]
  double gladstone_dale = 0.0;   ///< Gladstone-Dale constant K [m^3/kg]
  double ambient_index = 1.0;    ///< refractive index n0 of the surroundings of the medium [1]
  Vec2d axis_px{};               ///< pixel coordinates of the optical axis (column, row) [px]

  /// Returns the displacement per projected density gradient, M Z_D K / (n0 p) [px/(kg/m^3)].
  double sensitivity() const {
    return magnification * target_distance * gladstone_dale / (ambient_index * pixel_pitch);
  }
  /// Returns the magnification of the medium's mid-plane, M_A = M Z_B / Z_A with Z_B = Z_A + Z_D [1].
  double medium_magnification() const { return magnification * (lens_distance + target_distance) / lens_distance; }
};

/// Projected gradient and the number of vectors that were treated specially.
struct ProjectedGradient {
  GradientMap map;
  std::size_t invalid = 0;  ///< number of masked or invalid vectors, which are holes of the map
  /// Number of valid vectors without sigma in a field with sigmas; the largest sigma is assigned to them.
  std::size_t without_sigma = 0;
};

/// Converts the displacement of a BOS measurement on a regular grid to the projected density gradient,
///   integral of d(rho)/dx dz = -u n0 p / (M Z_D K),   integral of d(rho)/dy dz = +v n0 p / (M Z_D K),
/// in the world frame (x right, y up), where u and v are the displacement to the right and downwards. Rajendran, Bane &
/// Vlachos, Meas. Sci. Technol. 30 (2019), Eq. 9; valid for small angles and a medium thin compared with Z_D (relative
/// error eps^2 (2/3 + 7/24 L_z / Z_D), eps the deflection angle). The nodes are the positions of the vectors, divided
/// by the magnification M_A of the mid-plane; the rows are reversed so that y increases.
/// @param field  displacement [px] on an interrogation grid of at least 2 x 2 vectors
/// @return projected gradient and its sigma [kg/m^3]; sigma is empty if no vector has one
/// @throws SetupError  if a number of the optics is not positive and finite
/// @throws DataError   if the vectors are not on a regular grid, or a displacement is not finite at a valid vector
/// @throws DataError (code `no_valid_vector`)  if no vector is valid
ProjectedGradient compute_projected_gradient(DisplacementField const& field, ProjectionOptics const& optics);

/// Divides a projected gradient by the thickness of the medium and returns the mean density gradient along the line of
/// sight [kg/m^4].
/// @param thickness  thickness L_z of the medium [m]
/// @throws SetupError  if the thickness is not positive and finite
GradientMap compute_mean_gradient(GradientMap const& projected, double thickness);

}  // namespace gladstone::inline density
