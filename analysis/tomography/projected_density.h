#pragma once

#include <optional>
#include <vector>

#include "analysis/density/gradient_map.h"
#include "analysis/density/reference_density.h"
#include "analysis/tomography/volume_reconstruction.h"
#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline tomography {

/// Sight line of a vector, and the distance in the target plane that corresponds to one pixel.
struct VectorSight {
  SightLine line;
  /// Vector in the target plane that corresponds to one column and to one row of the image [m/px].
  Vec3d by_column{}, by_row{};
};

/// Optical properties of one view.
struct ViewOptics {
  std::vector<std::optional<VectorSight>> sights;  ///< sight line of each vector; nullopt: no chief ray passes the lens
  double gladstone_dale = 0.0;                     ///< Gladstone-Dale constant K [m^3/kg]
  double ambient_index = 1.0;                      ///< refractive index n0 of the surroundings [1]
};

/// Gradient of the weighted projection of the density (see SightLine) with respect to the pixel coordinates, on the
/// grid of the vectors with x = column and y = -row [px]:
///   dP/dpx = -(n0 / (K B)) scale (D . a - (D . d) (a . d)),
/// with the displacement D of the dot in the target plane, the vector a in the target plane that corresponds to one
/// pixel, the direction d of the sight line, its length B from the dot to the pupil, and SightLine::scale. For a camera
/// on the Z axis this is the gradient of density::compute_projected_gradient() times the size of a pixel in the
/// mid-plane. Valid for small angles; the neglected terms are smaller than the result by the ratio of the size of a
/// structure to the distance of the dots, times the obliquity of the line.
/// @param field  displacement on a regular grid [px]
/// @return gradient [kg/m^2/px], with sigma if the vectors have an uncertainty; vectors without a sight line are
///         invalid
/// @throws DataError  see density::compute_projected_gradient()
density::GradientMap compute_pixel_gradient(DisplacementField const& field, ViewOptics const& optics);

/// Integrates a gradient to line integrals of the density difference, by weighted least squares.
/// @param reference  nodes of known line integral, on the grid of `gradient`, which fix the constant of the integration
/// @return one sight line and line integral for each vector, in the order of the displacement field
/// @throws DataError, SetupError  see density::DensityIntegrator
ProjectedView integrate_view(density::GradientMap const& gradient, ViewOptics const& optics,
                             density::ReferenceDensity const& reference);

}  // namespace gladstone::inline tomography
