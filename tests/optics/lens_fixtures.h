#pragma once

#include <string>
#include <vector>

#include "render/base/units.h"
#include "render/optics/apparent_pupil.h"
#include "render/optics/paraxial.h"

namespace gladstone {

/// Surface of a lens under test, with lengths in mm.
struct SurfaceMm {
  double radius;  ///< radius of curvature [mm]; infinite: a plane
  double thickness;
  double index_after;
  bool stop = false;
  double conic = 0;
};

/// Builds a lens from surfaces in air. The first surface is the stop unless another one is. @param stop_semi_diameter
/// [mm]
inline Lens lens_of(std::vector<SurfaceMm> const& surfaces, double stop_semi_diameter) {
  Prescription prescription;
  prescription.file = "test";
  bool any_stop = false;
  for (SurfaceMm const& s : surfaces) any_stop = any_stop || s.stop;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    SurfaceMm const& s = surfaces[i];
    PrescribedSurface surface;
    surface.where = "test:" + std::to_string(i + 1);
    surface.curvature = 1 / (s.radius * unit::millimetre);
    surface.conic = s.conic;
    surface.thickness = s.thickness * unit::millimetre;
    if (s.index_after != 1) surface.after.is = PrescribedMedium::Index{s.index_after};
    surface.stop = s.stop || (!any_stop && i == 0);
    if (surface.stop) surface.semi_diameter = stop_semi_diameter * unit::millimetre;
    prescription.surfaces.push_back(surface);
  }
  return build_lens(prescription, GlassCatalogue::shipped(), spectral_line::d);
}

/// Traces a ray through all surfaces.
inline RayStatus carry(Lens const& lens, Ray<double>& ray, RayAccount<double>& account) {
  return lens.view().carry(ray, account);
}
inline RayStatus carry(Lens const& lens, Ray<double>& ray) {
  RayAccount<double> account;
  return carry(lens, ray, account);
}

/// Returns a ray parallel to the axis at a height [mm].
inline Ray<double> parallel_ray(double height_mm) { return {{0, height_mm * unit::millimetre, -0.1}, {0, 0, 1}}; }

/// Returns the height of a ray at a plane behind the last vertex [mm].
inline double height_behind(Lens const& lens, Ray<double> const& ray, double distance_mm) {
  double const z = lens.poses.back().origin.z + distance_mm * unit::millimetre;
  return (ray.position.y + (z - ray.position.z) * ray.direction.y / ray.direction.z) / unit::millimetre;
}

}  // namespace gladstone
