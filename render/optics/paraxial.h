#pragma once

#include "render/optics/lens.h"

namespace gladstone::inline optics {

/// Position and size of a pupil.
struct Pupil {
  double position = 0;  ///< position on the axis, from the reference vertex [m]; infinite for telecentric lenses
  double diameter = 0;  ///< [m]
};

/// Cardinal points and pupils of a lens from paraxial ray transfer (Welford 1986, chapter 3): y' = y + t u, n' u' = n u
/// - y c (n' - n). Distances are positive along +z, on the image side along the direction of the outgoing light. If
/// object or image space is not air, focal and principal distances there are multiplied by n; the effective focal
/// length is that in air, the reciprocal of the power.
struct ParaxialLens {
  double effective_focal_length = 0;  ///< focal length in air [m]; infinite for afocal lenses
  double back_focal_length = 0;       ///< distance from the last vertex to the rear focus [m]
  double front_focal_length = 0;      ///< distance from the first vertex to the front focus, negative ahead of the
                                      ///< vertex [m]
  double front_principal_plane = 0;   ///< distance from the first vertex [m]
  double rear_principal_plane = 0;    ///< distance from the last vertex [m]
  Pupil entrance;                     ///< entrance pupil, position from the first vertex
  Pupil exit;                         ///< exit pupil, position from the last vertex
  bool telecentric = false;           ///< object-side telecentric, see is_telecentric()
  double f_number = 0;  ///< effective focal length over entrance pupil diameter [1]; infinite if afocal or telecentric
};

/// Computes the paraxial properties of a lens. @pre the lens has a stop
ParaxialLens paraxial_lens(Lens const& lens);

/// Paraxial ray transfer matrix from just ahead of surface `first` to just ahead of surface `last` (or just behind the
/// last surface), for the ray height y [m] and the reduced slope n u [1].
struct RayTransfer {
  double a = 1, b = 0, c = 0, d = 1;  ///< y' = a y + b (n u), (n u)' = c y + d (n u)
};
RayTransfer ray_transfer(Lens const& lens, int first, int last);

/// Returns true if the entrance pupil is magnified more than 20 times relative to the stop, and hence about as far
/// away. Chief rays from a field as wide as the lens are then parallel to the axis to within a twentieth of the lens'
/// own field. Glass dispersion limits an infinite pupil distance to a single wavelength, hence the tolerance.
bool is_telecentric(RayTransfer const& to_stop);

}  // namespace gladstone::inline optics
