#pragma once

#include <cstddef>

#include "render/base/image.h"
#include "render/scene/renderer.h"
#include "studies/compare/cone_theory.h"

namespace gladstone::inline compare {

/// Sums over dots from which an Agreement is computed.
struct AgreementSums {
  /// sums of squares of the small-angle theory (Eq. 9), the aperture-averaged theory and the ray displacements, and of
  /// the product of Eq. 9 and rays [px^2]
  double eq9 = 0, cone = 0, rays = 0, eq9_rays = 0;
  std::size_t dots = 0;

  /// Adds dot i of `truth`; skips it unless its ray displacement is finite, that is, unless it is seen in both frames.
  void add(GroundTruth const& truth, std::size_t i);
  AgreementSums& operator+=(AgreementSums const& other);
  AgreementSums operator-(AgreementSums const& part) const;

  double eq9_px() const;   ///< rms per component of the small-angle theory (Eq. 9) [px]
  double cone_px() const;  ///< rms per component of the aperture-averaged theory [px]
  /// rms per component of the ray displacements [px]
  double rays_px() const;
  Agreement agreement() const;
};

/// Agreement of ray displacements with the small-angle theory (Eq. 9) over a whole plane.
struct PlaneAgreement {
  AgreementSums sums;
  /// Standard errors: expected difference between planes of this size and kind, estimated by the jackknife over sixteen
  /// square pieces of the plane.
  Agreement error;
};

/// Reads the values at the nodes of a field that is one periodic plane stored in a file.
Image<double> field_plane(FieldSetup const& field);

/// Traces a lattice of 96 x 96 dots that covers the setup's whole periodic square plane. The camera sees `nodes` x
/// `nodes` nodes of the plane at a time, so the plane is shifted and traced once for each of (plane nodes / nodes)^2
/// views.
/// @param setup    with render.rays_per_dot as a number and a target of discs or points; spacing and centre of its
///                 field and the positions of its dots are replaced
/// @param nodes    number of the plane's nodes across the view
/// @param spacing  distance between the plane's nodes [m]
/// @param renderer  traces the rays
/// @pre the number of views along an axis is an integer and divides 96
PlaneAgreement agreement_over_plane(Setup setup, int nodes, double spacing, Renderer& renderer);

}  // namespace gladstone::inline compare
