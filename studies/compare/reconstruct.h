#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/density/axisymmetric_inversion.h"
#include "analysis/density/density_integrator.h"
#include "analysis/density/projected_gradient.h"
#include "render/base/warning.h"
#include "render/files/source_files.h"
#include "render/scene/setup.h"
#include "studies/compare/compare.h"

namespace gladstone::inline compare {

/// Region of known density in the mid-plane of the medium: the vectors along one side of the image, or within a box.
struct ReferenceRegion {
  std::optional<density::GridSide> side;  ///< side of the image; empty: the box `low` to `high`
  int depth = 1;                          ///< number of columns or rows of vectors, counted from the side
  Vec2d low{}, high{};                    ///< corners of the box, x to the right and y up from the optical axis [m]
};

/// Axis of an axisymmetric flow.
struct AxisOption {
  density::AxisDirection direction = density::AxisDirection::vertical;
  std::optional<double> position;  ///< x of a vertical, y of a horizontal axis [m]; empty: found by symmetry
};

/// Options of a reconstruction of density.
struct ReconstructOptions {
  std::string vectors;                       ///< path of the vectors; empty: CASE/vectors.h5
  std::optional<std::string> conventions;    ///< conventions of the vectors given by the user; empty: those of the
                                             ///< file's format
  std::vector<ReferenceRegion> reference;    ///< regions of known density, which fix the constant of the integration;
                                             ///< empty for axisymmetric flows
  std::optional<double> reference_density;   ///< reference density; empty: ambient density of the setup [kg/m^3]
  double reference_sigma = 0.0;              ///< standard uncertainty of the reference density [kg/m^3]
  double scale_uncertainty = 0.0;            ///< combined relative uncertainty of M, Z_D, K, p and thickness [1]
  std::string method = "wls";                ///< one of density::integration_methods()
  std::optional<double> overlap;             ///< overlap of the interrogation windows, 0 to below 1 [1]; empty: as in
                                             ///< [correlate]
  std::optional<double> deconvolution_gain;  ///< largest gain of the aperture's deconvolution [1]; empty: none
  std::optional<AxisOption> axis;            ///< axisymmetric flow; empty: planar integration
  std::string abel = "direct";               ///< one of density::abel_methods()
  std::optional<double> lambda;  ///< parameter of a regularised Abel inversion [1]; empty: by cross-validation
  std::size_t samples = 400;     ///< number of random samples for the uncertainty of large grids
  bool propagate = true;         ///< true: compute the uncertainty from that of the vectors
  bool budget = false;           ///< split the error of a rendered case into its causes
};

/// Term of a density's error budget, see compute_density_budget().
struct DensityTerm {
  std::string name;              ///< cause: `integration`, or a term of the displacement's budget; `total`
  double bias = 0.0, rms = 0.0;  ///< mean and root mean square [kg/m^3]
};

/// Properties of an axisymmetric inversion; see density::AxisymmetricDensity.
struct AxisymmetryResult {
  density::AxisDirection direction = density::AxisDirection::vertical;
  density::SymmetryAxis axis;    ///< axis of symmetry [m]; sigma is NaN if the axis was given
  double lambda = 0.0;           ///< regularisation parameter [1]; 0: none
  double asymmetry = 0.0;        ///< rms of the even part of the gradient about the axis over that of the odd part [1]
  double border_gradient = 0.0;  ///< rms of the gradient at the largest radii over that of all radii [1]
};

/// Reconstructed density. Fields are stored row by row from the lowest row, NaN where not determined.
struct Reconstruction {
  density::PlaneGrid grid;  ///< nodes in the mid-plane of the medium, x right and y up from the optical axis [m]
  /// Mean over the thickness of the medium along the line of sight; for an axisymmetric flow in the plane through the
  /// axis perpendicular to the line of sight [kg/m^3, grid.size()].
  std::vector<double> density;
  std::vector<double> sigma;         ///< standard uncertainty [kg/m^3, grid.size()]; NaN: vectors without sigma
  std::vector<double> sigma_random;  ///< part of sigma due to the vectors [kg/m^3, grid.size()]
  /// Measured gradient, mean over the thickness; for an axisymmetric flow differences of the density
  /// [kg/m^4, grid.size()].
  std::vector<Vec2d> gradient;
  std::vector<std::int64_t> region;     ///< connected region of the node, 0: the largest; -1: no valid vector
  std::vector<std::int64_t> reference;  ///< 1: node of given density
  std::vector<double> truth;            ///< density of a rendered case [kg/m^3, grid.size()]; empty: unknown
  std::vector<DensityTerm> budget;      ///< causes of the error; empty: not requested
  double reference_density = 0.0;       ///< reference density [kg/m^3]
  density::WindowOverlap overlap;       ///< overlap of the windows, which correlates the vectors' errors
  double white_noise_gain = 1.0;        ///< noise amplification by the deconvolution [1]; 1: none
  std::size_t samples = 0;              ///< number of random samples for sigma; 0: exact
  std::optional<AxisymmetryResult> axisymmetry;
  Warnings warnings;
  std::string setup;         ///< resolved setup
  std::uint64_t seed = 0;    ///< random seed of the rendering
  std::string vectors;       ///< path of the vectors
  SourceFiles sources = {};  ///< setup, vectors, and truth
};

/// Errors of a reconstruction of a rendered case against its true density, over all nodes where both exist.
struct DensityErrors {
  std::size_t count = 0;
  double bias = 0.0, rms = 0.0, largest = 0.0;  ///< mean, root mean square and largest magnitude [kg/m^3]
  double contrast = 0.0;  ///< standard deviation of the true density, to compare with rms [kg/m^3]
  double coverage = 0.0;  ///< fraction of errors within sigma [1]; NaN without sigma
};
DensityErrors compute_density_errors(Reconstruction const& reconstruction);

/// Returns the size of the windows in units of the distance between vectors, at most that of the grid.
density::WindowOverlap determine_overlap(DisplacementField const& field, double window_px);

/// Returns the optics of a BOS setup that convert displacement to density gradient, for a camera on the Z axis.
density::ProjectionOptics make_projection_optics(Setup const& setup);

/// Reconstructs density from BOS vectors of a camera on the Z axis, in memory: displacement to projected gradient (Eq.
/// 9 of Rajendran, Bane & Vlachos 2019), then integration, optional deconvolution, or Abel inversion. Valid for small
/// angles and a medium thin compared with Z_D.
/// @param field      displacement on a complete grid [px]
/// @param window_px  size of the interrogation windows, for the correlation of errors unless options.overlap is set
/// @throws SetupError  for invalid options (no gauge, axis outside the image, ..) and unsupported setups
/// @throws DataError   if the vectors do not determine a density
Reconstruction reconstruct_density(DisplacementField const& field, Setup const& setup, double window_px,
                                   ReconstructOptions const& options);

}  // namespace gladstone::inline compare
