#pragma once

#include <vector>

#include "analysis/density/gradient_map.h"
#include "analysis/density/symmetry_axis.h"
#include "render/scene/field_map.h"
#include "render/scene/setup.h"

namespace gladstone::inline compare {

/// Interpolates the path-averaged density of a field map by cubics (Lagrange; linear in the outermost cells).
/// @param position_px  within the image, columns right and rows down [px]
/// @return             [kg/m^3, position_px.size()]
std::vector<double> interpolate_density(FieldMap const& map, std::vector<Vec2d> const& position_px);

/// Evaluates the density of a setup's medium in the plane Z = 0; ambient density outside of the medium. Builds the
/// medium, which reads its file.
/// @param grid  nodes, x right and y up from the optical axis [m]
/// @return      [kg/m^3, grid.size()]
std::vector<double> sample_middle_plane(MediumSetup const& setup, density::PlaneGrid const& grid);

}  // namespace gladstone::inline compare
