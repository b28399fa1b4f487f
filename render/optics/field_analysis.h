#pragma once

#include <limits>
#include <vector>

#include "render/optics/aim_disc.h"
#include "render/optics/lens.h"
#include "render/optics/paraxial.h"

namespace gladstone {

/// Rays that passed the stop, or would have, and ended at one surface for one cause.
struct LostRays {
  int surface;
  RayStatus cause;
  double share;  ///< of all that were sent towards the stop [1]
};

/// How a lens images one point of its object field.
struct FieldPoint {
  double angle = 0;             ///< of the object against the axis, in the y-z plane [rad]
  bool imaged = false;          ///< false: no ray gets through
  std::vector<Vec2d> spot;      ///< where rays that fill the stop evenly meet the image plane [m]
  Vec2d centroid{};             ///< of the spot [m]
  Vec2d chief{};                ///< where the chief ray meets the image plane [m]
  double spot_rms = 0;          ///< radius of the spot about its centroid [m]
  double best_spot_rms = 0;     ///< of its narrowest cross section [m]
  double best_focus = 0;        ///< where that stands, from the image plane [m]
  double distortion = 0;        ///< chief ray's height over the paraxial chief ray's, less one [1]
  double tangential_focus = 0;  ///< of a narrow bundle about the chief ray, from the image plane [m]
  double sagittal_focus = 0;
  double vignetting = 0;       ///< share of the stop's rays that another edge takes [1]
  std::vector<LostRays> lost;  ///< by surface, then by cause
};

/// What becomes of a lens' light over its field.
struct FieldAnalysis {
  double image_plane = 0;  ///< behind the last vertex: the prescription's, else the paraxial image [m]
  std::vector<FieldPoint> points;
};

/// Where the light of a field angle comes from: its direction, or the point of the object plane that the entrance pupil
/// sees under it.
RayOrigin field_origin(Lens const& lens, ParaxialLens const& paraxial, double angle);

/// Traces `rays` rays for every field angle of the prescription, spread evenly over the stop as the field point sees it
/// (Vogel 1979). The object stands where the prescription says.
FieldAnalysis analyse_field(Lens const& lens, ParaxialLens const& paraxial, int rays);

/// A ray followed from in front of the lens to the image plane, point by point, for drawings [m].
/// Ends where the ray is lost.
std::vector<Vec3d> follow_ray(Lens const& lens, Ray<double> ray, double image_plane);

}  // namespace gladstone
