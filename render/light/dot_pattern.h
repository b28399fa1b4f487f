#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/base/vec.h"
#include "render/light/sources.h"

namespace gladstone::inline light {

/// Light sources of a target, in the coordinates of the target plane. Owns the data of a SourcesView.
struct DotPattern {
  std::vector<Vec2d> centre;     ///< centres of the sources [m]
  std::vector<double> radiance;  ///< radiance relative to white [1]; empty: all one
  double half_size = 0;          ///< radius of the dots, or half the side of an image's pixels [m]
  SourceShape shape = SourceShape::disc;

  double radiance_of(std::size_t dot) const { return radiance.empty() ? 1.0 : radiance[dot]; }
  SourcesView<double> view(double plane_z) const {
    return {centre.data(), radiance.empty() ? nullptr : radiance.data(), centre.size(), plane_z, half_size, shape};
  }
};

/// Places discs at random in a rectangle about the origin, without overlap, by random sequential addition on a grid of
/// cells. Such patterns saturate at an area coverage of 0.547; coverages above 0.5 are rejected.
/// @param extent    width and height of the rectangle that contains the centres [m]
/// @param diameter  diameter of the discs [m]; 0: points, which may coincide
/// @throws DataError if not all discs can be placed
std::vector<Vec2d> random_dots(Vec2d extent, std::size_t count, double diameter, std::uint64_t seed);

/// Places discs on a square lattice about the origin, with the given number per area [1/m^2].
/// @throws DataError if neighbouring discs overlap
std::vector<Vec2d> regular_dots(Vec2d extent, double per_area, double diameter);

/// Reads dot centres from a CSV file with the header line x_mm,y_mm; coincident dots are rejected.
/// @param farthest  maximum of |x| and |y| [m]
/// @throws DataError with file:line
std::vector<Vec2d> dots_from_csv(std::string const& path, double farthest);

/// Converts an image file to a target. Every pixel is a uniform square whose radiance is its grey value relative to the
/// largest one; black pixels are omitted. The image fills the extent [m], columns along +X, rows along -Y.
/// @throws DataError if the image has values that are not finite, is black, or does not have the proportions of the
/// extent
DotPattern image_target(std::string const& path, Vec2d extent);

}  // namespace gladstone::inline light
