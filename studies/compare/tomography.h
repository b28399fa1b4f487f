#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/tomography/volume_reconstruction.h"
#include "render/base/pose.h"
#include "render/base/warning.h"
#include "render/files/source_files.h"
#include "studies/compare/reconstruct.h"

namespace gladstone::inline compare {

/// Part of a volume outside of which the density is the reference density: a sphere about the origin of the volume, or
/// a cylinder about its Y axis.
struct VolumeSupport {
  enum class Shape { sphere, cylinder } shape = Shape::sphere;
  double radius = 0.0;  ///< [m]
};

/// Options of a tomographic reconstruction.
struct TomographyOptions {
  std::vector<std::string> views;          ///< case folder of each view, or its setup together with `vectors`
  std::vector<std::string> vectors;        ///< vectors of each view; empty: CASE/vectors.h5
  bool ray_truth = false;                  ///< use the true displacement of the dots of rendered cases
  std::optional<std::string> conventions;  ///< conventions of the vectors given by the user; empty: those of the file's
                                           ///< format
  std::vector<double> angles;      ///< angle of the volume about Y in each view [rad]; empty: i / views of `arc`
  double arc = 3.141592653589793;  ///< range of the default angles [rad]
  std::vector<ReferenceRegion> reference;  ///< region of each view whose lines of sight meet the reference density only
  std::optional<double> reference_density;     ///< [kg/m^3]; empty: ambient density of the setups
  std::optional<std::array<Vec3d, 2>> bounds;  ///< lowest and highest corner of the volume [m]; empty: common view
  std::optional<double> spacing;               ///< distance between nodes [m]; empty: that of the vectors
  /// part outside of which the density is known; empty: the whole volume is reconstructed
  std::optional<VolumeSupport> support;
  double least_density = 0.0;                                        ///< lower bound of the density [kg/m^3]
  double largest_density = std::numeric_limits<double>::infinity();  ///< upper bound [kg/m^3]
  tomography::SartSettings sart;  ///< bounds and support are set from the members above
};

/// Density of a volume, reconstructed from several views.
struct Tomography {
  RegularGrid grid;                   ///< nodes in the frame of the volume
  std::vector<double> density;        ///< density at the nodes [kg/m^3, grid.size()], x fastest
  std::vector<std::int64_t> seen;     ///< number of views that see the node [grid.size()]
  std::vector<double> truth;          ///< true density of rendered cases [kg/m^3, grid.size()]; empty: unknown
  std::vector<double> residual;       ///< relative residual of each sweep, see tomography::VolumeReconstruction [1]
  std::vector<double> view_residual;  ///< residual of each view, see tomography::VolumeReconstruction [1, views]
  double reference_density = 0.0;     ///< [kg/m^3]
  double tv_weight = 0.0;             ///< strength of the total variation in the last sweep, see SartSettings [1]
  std::string device = "cpu";         ///< device of the reconstruction
  double outside = 0.0;               ///< fraction of the squared line integrals on lines that miss the grid [1]
  std::vector<std::string> views;     ///< names of the inputs
  std::vector<double> angles;         ///< angle of the volume in each view [rad]
  std::vector<std::size_t> vectors;   ///< number of vectors of each view with a line integral
  tomography::SartSettings settings;
  Warnings warnings;
  std::string setup;         ///< resolved setup of the first view
  std::uint64_t seed = 0;    ///< random seed of the rendering
  SourceFiles sources = {};  ///< setups and vectors
};

/// Returns the relative L2 error of the density difference from the reference, over all nodes [1].
/// @pre result.truth is not empty
double compute_relative_error(Tomography const& result);

/// Returns the pose of a volume that is turned about the Y axis of a view's world.
/// @param angle  right-handed about Y [rad]
Pose<double> turned_volume(double angle);

/// Reads the vectors and the camera of each view, converts the displacement to line integrals of the density, and
/// reconstructs the volume. Lines of sight are the straight chief rays of the cameras; optical windows are neglected,
/// with a warning. Writes nothing.
/// @param make_volume  creates the volume on the device of the iteration, see open_volume_device()
/// @throws SetupError, DataError  for options, setups and vectors that do not determine a volume; DeviceError
Tomography reconstruct_views(TomographyOptions const& options, tomography::SartVolumeMaker const& make_volume);

}  // namespace gladstone::inline compare
