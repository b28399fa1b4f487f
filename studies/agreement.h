#pragma once

#include <cstddef>

#include "render/base/image.h"
#include "render/scene/renderer.h"
#include "studies/cone_theory.h"

namespace gladstone {

/// Sums over dots that agreement comes from.
struct AgreementSums {
  double eq9 = 0, cone = 0, rays = 0, eq9_rays = 0;  ///< of squares and of the product [px^2]
  std::size_t dots = 0;

  /// Adds a dot that has rays in both frames; leaves out another.
  void add(GroundTruth const& truth, std::size_t i);
  AgreementSums& operator+=(AgreementSums const& other);
  AgreementSums operator-(AgreementSums const& part) const;

  double eq9_px() const;   ///< rms per component
  double cone_px() const;  ///< the same of Eq. 9 averaged over the cone
  double rays_px() const;
  Agreement agreement() const;
};

/// Agreement over a whole plane.
struct PlaneAgreement {
  AgreementSums sums;
  /// Standard errors: how much a plane of this size would differ from another of the same kind, by leaving out one of
  /// sixteen square pieces of the plane after the other (jackknife).
  Agreement error;
};

/// The plane's nodes of a setup whose field is one periodic plane in a file.
Image<double> field_plane(FieldSetup const& field);

/// Traces dots on one lattice, 96 by 96, over the whole of the setup's periodic square plane, of which the view shows
/// `nodes` by `nodes` nodes at `spacing` at a time: as many views as the plane holds.
/// @param setup with rays_per_dot as a number and a target of discs or points; spacing and centre of its field do not
///              count, nor do the places of its dots
/// @param spacing of the plane's nodes [m]
/// @pre the plane holds 1, 2, 3, 4, 6, 8 ... views along an axis, a divisor of 96
PlaneAgreement agreement_over_plane(Setup setup, int nodes, double spacing, Renderer& renderer);

}  // namespace gladstone
