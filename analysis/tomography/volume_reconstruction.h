#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "analysis/tomography/sart_volume.h"
#include "analysis/tomography/sight_line.h"
#include "render/base/regular_grid.h"

namespace gladstone::tomography {

/// Smallest number of views, and of views that must see one part of the volume.
inline constexpr std::size_t least_views = 3;

/// Line integrals of a density difference along the sight lines of one view.
struct ProjectedView {
  std::string name;              ///< for messages
  std::vector<SightLine> lines;  ///< [vectors]
  std::vector<double> value;     ///< weighted line integral [kg/m^2, vectors]; NaN: not measured
};

/// Settings of SART with total variation.
struct SartSettings {
  int iterations = 100;     ///< largest number of sweeps over all views
  double tolerance = 1e-3;  ///< the last sweep changes the volume by less than this fraction of its L2 norm [1]
  double relaxation = 0.5;  ///< fraction of the correction that is applied after each view, above 0 and below 2 [1]
  /// Strength of the total variation, relative to the largest difference [1]; 0: none; empty: see
  /// choose_tv_strength()
  std::optional<double> tv_weight;
  int tv_iterations = 10;                                    ///< dual iterations of the denoising after each sweep
  double lowest = -std::numeric_limits<double>::infinity();  ///< smallest density difference [kg/m^3]
  double highest = std::numeric_limits<double>::infinity();  ///< largest density difference [kg/m^3]
  std::vector<std::uint8_t> support;  ///< 1: the difference may differ from zero [grid.size()]; empty: everywhere
};

/// Volume of a density difference and the course of its reconstruction.
struct VolumeReconstruction {
  RegularGrid grid;
  std::vector<double> value;        ///< density difference [kg/m^3, grid.size()]; 0 where no view sees the node
  std::vector<std::int64_t> views;  ///< number of views with a line through the cells of the node [grid.size()]
  std::vector<double> residual;  ///< norm of A x - b over that of b in each sweep, each view before its correction [1]
  /// RMS of A x - b of each view in the last sweep, before its correction, over the rms of b of all views [1, views]
  std::vector<double> view_residual;
  double tv_weight = 0.0;      ///< strength of the total variation in the last sweep, see SartSettings [1]
  std::string device = "cpu";  ///< device of the iteration
  double outside = 0.0;        ///< fraction of the squared line integrals on lines that miss the grid [1]
};

/// Chooses the strength of the total variation after a sweep: the rms change of a node by the views, but at least 90 %
/// of the strength in the preceding sweep. No noise level needs to be known.
///
/// - Denoising changes a node by lambda div p, with a dual field p of vectors of at most unit length. Their divergence
///   has an rms value of sqrt(2) where their directions are independent, that is in noise, and about 2 / d in a
///   structure with a diameter of d nodes. With lambda equal to the rms change, denoising can therefore undo the change
///   completely only if it is noise, or a structure of two nodes. The change decreases with lambda if the line
///   integrals are consistent, and remains at the level of the noise that a sweep projects back otherwise. Sidky & Pan
///   (2008) couple the steps of total variation to the change by the projections in the same way.
/// - What the views do not determine follows from the total variation alone, and is found in as many sweeps as lambda
///   takes to decrease (continuation; Hale, Yin & Zhang, SIAM J. Optim. 19 (2008) 1107).
/// @param change    sum of the squares of the changes [kg^2/m^6]
/// @param nodes     number of nodes that the views change
/// @param previous  strength in the preceding sweep; 0 before the first [kg/m^3]
/// @return lambda [kg/m^3]
double choose_tv_strength(double change, std::size_t nodes, double previous);

/// Reconstructs a volume from line integrals by the simultaneous algebraic reconstruction technique: after each view,
/// every node receives the weighted mean of the residuals of its lines, each divided by the sum of the line's weights
/// (Andersen & Kak, Ultrason. Imaging 6 (1984) 81). Views follow one another in the order of the golden ratio. After
/// each sweep over the views, total-variation denoising, bounds and support are applied (Sidky & Pan, Phys. Med. Biol.
/// 53 (2008) 4777, with a proximal step in place of their gradient steps). Reports its progress. The result does not
/// depend on the number of threads, and on the device by rounding only. Needs 72 bytes per node.
/// @param grid         at least 2 nodes along each axis, not periodic
/// @param make_volume  creates the volume on the device of the iteration
/// @throws SetupError   for settings or grids that are out of range
/// @throws DataError    for fewer than three views, lines and values that differ in number, or views without a common
///                      part of the volume
/// @throws DataError, DeviceError, Interrupted
VolumeReconstruction reconstruct_volume(std::vector<ProjectedView> const& views, RegularGrid const& grid,
                                        SartSettings const& settings,
                                        SartVolumeMaker const& make_volume = make_host_volume);

/// View whose line integrals contradict those of the others.
struct ContradictingView {
  std::size_t view;  ///< index
  double ratio;      ///< residual of the view over the lower median of the other views [1]
};

/// Finds views that contradict the others: their residual is at least 1.4 times the lower median of the other views,
/// 10 % of the rms line integral, and 70 % of the largest residual, since the views next to a wrong one do not fit
/// either. For 3 to 16 views of blobs and of turbulence with up to 5 % of noise, consistent views have at most 1.25
/// times the residual of the others where it exceeds 10 %; a view with the wrong sign, with a factor of 1.5, or shifted
/// by a twelfth of the volume along the axis of rotation has 1.8 to 19 times this residual. Of three views, two may be
/// named. Shifts and mirror images across the axis contradict the others from some 8 views on only: fewer views have
/// another volume in common.
/// @param view_residual  see VolumeReconstruction
std::vector<ContradictingView> find_contradicting_views(std::vector<double> const& view_residual);

/// Relative L2 error, |value - truth| / |truth|, over all nodes [1]; infinite if the truth is zero.
double compute_relative_error(std::vector<double> const& value, std::vector<double> const& truth);

}  // namespace gladstone::tomography
