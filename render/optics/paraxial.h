#pragma once

#include "render/optics/lens.h"

namespace gladstone {

/// A pupil: where it stands and how wide it is.
struct Pupil {
  double position = 0;  ///< along the axis, from the vertex it is measured from; infinite for telecentric lenses [m]
  double diameter = 0;  ///< [m]
};

/// Cardinal points and pupils of a lens by ray transfer (Welford 1986, chapter 3): y' = y + t u,
/// n' u' = n u - y c (n' - n). Positive distances run along +z, those on the image's side along the light that leaves.
/// Where object or image space is not air, focal and principal distances there are n times as long; the effective focal
/// length is that in air, one over the power.
struct ParaxialLens {
  double effective_focal_length = 0;  ///< infinite for afocal lenses [m]
  double back_focal_length = 0;       ///< last vertex to the rear focus [m]
  double front_focal_length = 0;      ///< first vertex to the front focus, negative in front of it [m]
  double front_principal_plane = 0;   ///< from the first vertex [m]
  double rear_principal_plane = 0;    ///< from the last vertex [m]
  Pupil entrance;                     ///< from the first vertex
  Pupil exit;                         ///< from the last vertex
  bool telecentric = false;           ///< towards the object: see is_telecentric()
  double f_number = 0;                ///< effective focal length over the entrance pupil's diameter [1]; infinite for
                                      ///< afocal and telecentric lenses
};

/// @pre the lens has a stop
ParaxialLens paraxial_lens(Lens const& lens);

/// Ray transfer from just before surface `first` to just before surface `last`, or behind the last one: what it makes
/// of height y [m] and reduced slope n u [1].
struct RayTransfer {
  double a = 1, b = 0, c = 0, d = 1;  ///< y' = a y + b (n u), (n u)' = c y + d (n u)
};
RayTransfer ray_transfer(Lens const& lens, int first, int last);

/// Whether the entrance pupil is the stop magnified more than twenty times, and so about as far away: chief rays of a
/// field as wide as the lens then run parallel to its axis within a twentieth of the lens' own field. At one wavelength
/// a lens of glass has its pupil at infinity, at others but far away.
bool is_telecentric(RayTransfer const& to_stop);

}  // namespace gladstone
