#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/vec.h"
#include "render/light/sources.h"

namespace gladstone {

/// The sources of a target in the target's plane: owner of what SourcesView shows.
struct DotPattern {
  std::vector<Vec2d> centre;     ///< [m]
  std::vector<double> radiance;  ///< empty: all one
  double half_size = 0;          ///< radius of the dots, or half the side of a picture's pixels [m]
  SourceShape shape = SourceShape::disc;

  double radiance_of(std::size_t dot) const { return radiance.empty() ? 1.0 : radiance[dot]; }
  SourcesView<double> view(double plane_z) const {
    return {centre.data(), radiance.empty() ? nullptr : radiance.data(), centre.size(), plane_z, half_size, shape};
  }
};

/// Discs at random places in a rectangle about the axis, no two of them overlapping (random sequential addition on a
/// grid of cells; about 0.5 of the area is the most that such a pattern covers, 0.547 in the limit).
/// @param extent   width and height [m]; discs lie with their centres inside
/// @param diameter [m]; 0: points
/// @throws DataError when the area is too full for that many
std::vector<Vec2d> random_dots(Vec2d extent, std::size_t count, double diameter, std::uint64_t seed);

/// Discs on a square lattice of the given number per area [1/m^2], centred on the axis.
/// @throws DataError when neighbours would overlap
std::vector<Vec2d> regular_dots(Vec2d extent, double per_area, double diameter);

/// Dots from a CSV file with the header line x_mm,y_mm, no two at one place.
/// @param farthest that a dot may lie off the axis in x or y [m] @throws DataError with file:line
std::vector<Vec2d> dots_from_csv(std::string const& path, double farthest);

/// A picture as a target: every pixel a uniform square whose radiance is its grey value over the largest one; black
/// pixels send no rays. The picture is laid over the extent, its columns along +X and its rows along -Y.
DotPattern picture_target(std::string const& path, Vec2d extent);

}  // namespace gladstone
