#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "analysis/tomography/sart_volume.h"
#include "analysis/tomography/sight_line.h"
#include "render/base/regular_grid.h"

namespace gladstone::inline tomography {

/// Minimum number of views, which is also the minimum number of views that must see a common part of the volume.
inline constexpr std::size_t least_views = 3;

/// Line integrals of a density difference along the sight lines of one view.
struct ProjectedView {
  std::string name;              ///< name of the view in messages
  std::vector<SightLine> lines;  ///< sight line of each vector [vectors]
  std::vector<double> value;     ///< weighted line integral [kg/m^2, vectors]; NaN: not measured
};

/// Settings of SART with total variation.
struct SartSettings {
  int iterations = 100;     ///< largest number of sweeps over all views
  double tolerance = 1e-3;  ///< relative change of the volume (L2 norm) below which the iteration ends [1]
  double relaxation = 0.5;  ///< fraction of the correction that is applied after each view, above 0 and below 2 [1]
  /// Strength of the total variation, relative to the largest density difference [1]; 0: no total variation; empty:
  /// chosen by choose_tv_strength().
  std::optional<double> tv_weight;
  int tv_iterations = 10;                                    ///< dual iterations of the denoising after each sweep
  double lowest = -std::numeric_limits<double>::infinity();  ///< smallest density difference [kg/m^3]
  double highest = std::numeric_limits<double>::infinity();  ///< largest density difference [kg/m^3]
  std::vector<std::uint8_t> support;  ///< 1: the difference may differ from zero [grid.size()]; empty: everywhere
};

/// Volume of a density difference and the course of its reconstruction.
struct VolumeReconstruction {
  RegularGrid grid;
  std::vector<double> value;  ///< density difference [kg/m^3, grid.size()]; 0 where no view sees the node
  /// Number of views with a sight line through a cell adjacent to the node [grid.size()].
  std::vector<std::int64_t> views;
  /// Ratio of the norm of A x - b to the norm of b in each sweep; A x of each view is computed before its correction
  /// [1].
  std::vector<double> residual;
  /// Ratio of the rms of A x - b of each view in the last sweep, before the correction by this view, to the rms of b of
  /// all views [1, views].
  std::vector<double> view_residual;
  double tv_weight = 0.0;      ///< strength of the total variation in the last sweep, see SartSettings [1]
  std::string device = "cpu";  ///< device on which the iteration ran
  double outside = 0.0;        ///< fraction of the squared line integrals on lines that miss the grid [1]
};

/// Chooses the strength of the total variation after a sweep: the rms change of a node by the views, but at least 90 %
/// of the strength in the preceding sweep. No noise level needs to be known.
///
/// - Denoising changes a node by lambda div p, with a dual field p of vectors of at most unit length. The divergence of
///   p has an rms value of sqrt(2) in noise, where the directions of the vectors are independent, and about 2 / d in a
///   structure with a diameter of d nodes. With lambda equal to the rms change, denoising can therefore undo the change
///   completely only if the change is noise or a structure of two nodes. If the line integrals are consistent, the
///   change decreases together with lambda; otherwise it remains at the level of the noise that a sweep projects back.
///   Sidky & Pan (2008) couple the steps of total variation to the change by the projections in the same way.
/// - Components of the volume that the views do not determine follow from the total variation alone; they converge as
///   slowly as lambda decreases (continuation; Hale, Yin & Zhang, SIAM J. Optim. 19 (2008) 1107).
/// @param change  sum of the squared changes of the nodes by the views [kg^2/m^6]
/// @param nodes     number of nodes that the views change
/// @param previous  strength in the preceding sweep; 0 before the first [kg/m^3]
/// @return lambda [kg/m^3]
double choose_tv_strength(double change, std::size_t nodes, double previous);

/// Reconstructs a volume from line integrals by the simultaneous algebraic reconstruction technique: after each view,
/// every node receives the weighted mean of the residuals of its lines, each divided by the sum of the line's weights
/// (Andersen & Kak, Ultrason. Imaging 6 (1984) 81). The views are used in an order derived from the golden ratio, so
/// that consecutive views differ strongly. After each sweep over the views, total-variation denoising, bounds and
/// support are applied (Sidky & Pan, Phys. Med. Biol. 53 (2008) 4777, with a proximal step in place of their gradient
/// steps). Reports its progress. The result does not depend on the number of threads; results of different devices
/// differ by rounding only. Requires 72 bytes of memory per node.
/// @param grid         at least 2 nodes along each axis, not periodic
/// @param make_volume  creates the volume on the device that performs the iteration
/// @throws SetupError   for settings or grids that are out of range
/// @throws DataError    for fewer than three views, for numbers of lines and values that differ, or if no part of the
///         volume is seen by three views
/// @throws DataError, DeviceError, Interrupted
VolumeReconstruction reconstruct_volume(std::vector<ProjectedView> const& views, RegularGrid const& grid,
                                        SartSettings const& settings,
                                        SartVolumeMaker const& make_volume = make_host_volume);

/// View whose line integrals contradict those of the other views.
struct ContradictingView {
  std::size_t view;  ///< index of the view
  double ratio;      ///< ratio of the view's residual to the lower median of the other views' residuals [1]
};

/// Finds views that contradict the other views. The residual of such a view is at least 1.4 times the lower median of
/// the other views' residuals, 10 % of the rms line integral, and 70 % of the largest residual. The last condition
/// excludes correct views next to a wrong one, whose residuals are also large. For 3 to 16 views of blobs and of
/// turbulence with up to 5 % of noise, a consistent view with a residual above 10 % has at most 1.25 times the residual
/// of the other views. A view with the wrong sign, with a wrong factor of 1.5, or with a shift of a twelfth of the
/// volume along the axis of rotation has 1.8 to 19 times their residual. For three views, the function may return two
/// of them. A view that is shifted or mirrored across the axis of rotation is detected only if there are at least about
/// 8 views, because fewer views are also consistent with another volume.
/// @param view_residual  see VolumeReconstruction
std::vector<ContradictingView> find_contradicting_views(std::vector<double> const& view_residual);

/// Returns the relative L2 error over all nodes, |value - truth| / |truth| [1]; infinite if the truth is zero.
double compute_relative_error(std::vector<double> const& value, std::vector<double> const& truth);

}  // namespace gladstone::inline tomography
