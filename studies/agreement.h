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

  /// Adds the dots of a truth that have rays in both frames and are seen by the camera.
  void add(GroundTruth const& truth, std::size_t i);
  AgreementSums& operator+=(AgreementSums const& other);
  AgreementSums operator-(AgreementSums const& part) const;

  double eq9_px() const;   ///< rms per component
  double cone_px() const;  ///< the same of Eq. 9 averaged over the cone
  double rays_px() const;
  Agreement agreement() const;
};

/// Over the dots of a truth that the camera sees.
AgreementSums agreement_in_view(Scene const& scene, GroundTruth const& truth);

/// Agreement over a whole plane.
struct PlaneAgreement {
  AgreementSums sums;
  /// Standard errors: how much a plane of this size would differ from another of the same kind, by leaving out one of
  /// sixteen square pieces of the plane after the other (jackknife).
  Agreement error;
};

/// The plane's nodes of a setup whose field is one periodic plane in a file.
Image<double> field_plane(FieldSetup const& field);

/// Spacing at which so many nodes reach across `width` [m].
inline double spacing_across(double width, int nodes) { return width / (nodes - 1); }

/// Traces the setup's dots over the whole of its periodic square plane, of which the view shows `nodes` by `nodes`
/// nodes at `spacing` at a time: as many views as the plane holds, which share the dots of one.
/// @param setup with rays_per_dot as a number; spacing and centre of its field do not count
/// @pre the plane's nodes are a multiple of `nodes`
PlaneAgreement agreement_over_plane(Setup setup, int nodes, double spacing, Renderer& renderer);

}  // namespace gladstone
