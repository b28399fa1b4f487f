#pragma once

namespace gladstone::inline density {

/// Cone of rays from a point of the dot plane, which is in focus, to the entrance pupil.
struct ApertureCone {
  double pupil_diameter = 0.0;  ///< diameter of the entrance pupil, d_A = f/N, focal length over f-number [m]
  /// Z_A, distance from the front principal plane of the lens to the medium's mid-plane [m].
  double lens_distance = 0.0;
  double target_distance = 0.0;  ///< Z_D, distance from the medium's mid-plane to the dot plane [m]
  double thickness = 0.0;        ///< thickness L_z of the medium [m]

  /// Diameter of the cone in the medium's mid-plane, D_c = d_A Z_D / (Z_A + Z_D) [m].
  double diameter() const { return pupil_diameter * target_distance / (lens_distance + target_distance); }
};

/// Computes the transfer function H of the averaging over the aperture cone, for a density wave whose wave vector is
///   perpendicular to the line of sight, H = integral s H_c ds / integral s ds,   H_c = 2 J1(pi D_c(s) q) / (pi D_c(s)
///   q),   D_c(s) = d_A s / (Z_A + Z_D), integrated over the distances s of the medium's slices from the dots. The
///   weight is s, because a deflection at the distance s displaces the dot image in proportion to s. Valid for a
///   uniformly lit circular pupil, focus on the dots and deflections that hardly change the cone. H agrees with ray
///   tracing to within 2e-5.
/// @param wavenumber  q = 1/wavelength [1/m]
/// @return            amplitude relative to infinitely thin rays [1]; negative beyond the first zero (D_c q = 1.22)
double compute_aperture_transfer(ApertureCone const& cone, double wavenumber);

}  // namespace gladstone::inline density
