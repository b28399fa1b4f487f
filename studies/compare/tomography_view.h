#pragma once

#include "analysis/tomography/projected_density.h"
#include "studies/case/case.h"
#include "studies/compare/tomography.h"

namespace gladstone::inline compare {

/// One view of a tomographic measurement, in the frame of the volume.
struct TomographyView {
  CaseSetup loaded;
  tomography::ProjectedView projected = {};
  Vec3d view_direction{};                 ///< direction from the volume towards the camera
  std::vector<Vec3d> middle_points = {};  ///< points of the lines of sight that are closest to the volume's origin [m]
  double spacing = 0.0;                   ///< distance between the lines of adjacent vectors at these points [m]
  std::size_t unreferenced = 0;           ///< vectors in regions without reference, which have no line integral
  bool rendered = false;                  ///< true: the view is a rendered case, whose setup contains the true field
};

/// Reads a view and converts its displacement to line integrals.
/// @param index    index of the view in options.views
/// @param angle    angle of the volume about Y [rad]
/// @param sources  receives the files
/// @throws SetupError, DataError
TomographyView read_tomography_view(TomographyOptions const& options, std::size_t index, double angle,
                                    SourceFiles& sources);

/// Returns the optics of a view for vectors at the given pixels: chief rays, traced back from the sensor to the dots.
/// @param at_px  positions of the vectors [px]
/// @param volume  pose of the volume in the view's world, in whose frame the lines are returned
/// @throws DataError if no chief ray passes
tomography::ViewOptics trace_sight_lines(Setup const& setup, std::vector<Vec2d> const& at_px,
                                         Pose<double> const& volume);

}  // namespace gladstone::inline compare
