#pragma once

#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace gladstone {

/// How far rays are traced.
enum class Through { medium, optics, all };

/// Where a given ray ended; what is undefined is NaN.
struct TracedRay {
  RayStatus status = RayStatus::alive;
  Vec3d position;           ///< [m]
  Vec3d direction;          ///< unit length
  double optical_path = 0;  ///< from the start [m]; NaN behind a thin lens
  Vec2d pixel;              ///< on the sensor
};

/// Reads x_mm,y_mm,z_mm,dx,dy,dz (world frame; directions of any length).
/// @param farthest that a ray may start from the origin in any direction [m] @throws DataError with file:line
std::vector<Ray<double>> read_rays(std::string const& path, double farthest);

/// Traces rays through the medium, the lens, up to the sensor. A ray that misses the medium comes out of it as it went
/// in.
std::vector<TracedRay> trace_rays(Scene const& scene, std::vector<Ray<double>> const& rays, Through through);

/// status,x_mm,y_mm,z_mm,dx,dy,dz,opl_mm,col_px,row_px with 17 significant digits.
std::string traced_rays_csv(std::vector<TracedRay> const& rays);

}  // namespace gladstone
