#pragma once

#include <vector>

#include "render/optics/apparent_pupil.h"
#include "render/optics/lens.h"
#include "render/optics/paraxial.h"

namespace gladstone::inline optics {

/// Rays lost at one surface for one reason. Rays that pass the plane of the stop outside its radius are not counted.
struct SurfaceRayLoss {
  int surface;
  RayStatus cause;
  double share;  ///< fraction of all rays traced for the field point [1]
};

/// Image quality of a lens at one field point.
struct FieldPoint {
  double angle = 0;          ///< field angle in the y-z plane [rad]
  bool imaged = false;       ///< false: no ray reaches the image
  std::vector<Vec2d> spot;   ///< spot diagram: image-plane intersections of rays that fill the stop uniformly [m]
  Vec2d centroid{};          ///< centroid of the spot diagram [m]
  Vec2d chief{};             ///< intersection of the chief ray with the image plane [m]
  double spot_rms = 0;       ///< rms radius of the spot diagram about its centroid [m]
  double best_spot_rms = 0;  ///< rms radius at best focus [m]
  double best_focus = 0;     ///< distance of the best focus from the image plane [m]
  double distortion = 0;     ///< relative difference of the chief ray's height from that of the paraxial chief ray [1]
  double tangential_focus = 0;  ///< tangential focus of a narrow bundle about the chief ray, from the image plane [m]
  double sagittal_focus = 0;    ///< sagittal focus, from the image plane [m]
  double vignetting = 0;        ///< fraction of the rays through the stop that do not reach the image [1]
  std::vector<SurfaceRayLoss> lost;  ///< lost rays, sorted by surface, then by reason
};

/// Analysis of a lens over its field.
struct FieldAnalysis {
  double image_plane = 0;  ///< position behind the last vertex: prescribed image distance, else paraxial image [m]
  std::vector<FieldPoint> points;
};

/// Returns the origin of the rays of a field angle: a direction for objects at infinity, else the point of the object
/// plane that is seen under this angle from the entrance pupil.
RayOrigin field_origin(Lens const& lens, ParaxialLens const& paraxial, double angle);

/// Analyses the lens at every field angle of its prescription, for an object at the prescribed distance.
/// @param rays  number of rays per field point, distributed uniformly over the entrance pupil (Vogel 1979)
FieldAnalysis analyse_field(Lens const& lens, ParaxialLens const& paraxial, int rays);

/// Returns the polyline of a ray from its start to the image plane, for drawings [m]. It ends where the ray is lost.
std::vector<Vec3d> follow_ray(Lens const& lens, Ray<double> ray, double image_plane);

}  // namespace gladstone::inline optics
