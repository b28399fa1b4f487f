#pragma once

#include <string>
#include <vector>

#include "render/scene/scene.h"

namespace gladstone::inline cases {

/// End of the traced path: after the medium, after the lens, or at the sensor.
enum class Through { medium, optics, all };

/// Final state of a given ray; undefined quantities are NaN.
struct TracedRay {
  RayStatus status = RayStatus::alive;
  Vec3d position;           ///< [m]
  Vec3d direction;          ///< unit length
  double optical_path = 0;  ///< length of the optical path from the start [m]; NaN after a thin lens
  Vec2d pixel;              ///< position on the sensor
};

/// Reads rays from a CSV file with columns x_mm,y_mm,z_mm,dx,dy,dz (world frame; directions of any length).
/// @param farthest  largest admissible coordinate of a start point [m]
/// @throws DataError with file:line
std::vector<Ray<double>> read_rays(std::string const& path, double farthest);

/// Returns the rays of a table with rows x_mm, y_mm, z_mm, dx, dy, dz, stored row by row.
/// @param name      name of the table, for messages
/// @param farthest  largest admissible coordinate of a start point [m]
/// @throws DataError at name:row, counted from 0
std::vector<Ray<double>> rays_of(std::vector<double> const& rows, std::string const& name, double farthest);

/// Traces rays through the medium and the lens to the sensor. A ray that misses the medium is not changed by it.
std::vector<TracedRay> trace_rays(Scene const& scene, double step, std::vector<Ray<double>> const& rays,
                                  Through through);

/// Formats rays as CSV: status,x_mm,y_mm,z_mm,dx,dy,dz,opl_mm,col_px,row_px with 17 significant digits.
std::string traced_rays_csv(std::vector<TracedRay> const& rays);

}  // namespace gladstone::inline cases
