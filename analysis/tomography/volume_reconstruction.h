#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

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
  int iterations = 20;      ///< sweeps over all views
  double relaxation = 0.5;  ///< fraction of the correction that is applied after each view, above 0 and below 2 [1]
  double tv_weight = 0.01;  ///< strength of the total variation, relative to the largest difference [1]; 0: none
  int tv_iterations = 10;   ///< dual iterations of the denoising after each sweep
  double lowest = -std::numeric_limits<double>::infinity();  ///< smallest density difference [kg/m^3]
  double highest = std::numeric_limits<double>::infinity();  ///< largest density difference [kg/m^3]
  std::vector<std::uint8_t> support;  ///< 1: the difference may differ from zero [grid.size()]; empty: everywhere
};

/// Volume of a density difference and the course of its reconstruction.
struct VolumeReconstruction {
  RegularGrid grid;
  std::vector<double> value;        ///< density difference [kg/m^3, grid.size()]; 0 where no view sees the node
  std::vector<std::int64_t> views;  ///< number of views with a line through the cells of the node [grid.size()]
  std::vector<double> residual;     ///< norm of A x - b over that of b in the last views of each sweep [1, iterations]
  double outside = 0.0;             ///< fraction of the squared line integrals on lines that miss the grid [1]
};

/// Reconstructs a volume from line integrals by the simultaneous algebraic reconstruction technique: after each view,
/// every node receives the weighted mean of the residuals of its lines, each divided by the sum of the line's weights
/// (Andersen & Kak, Ultrason. Imaging 6 (1984) 81). Views follow one another in the order of the golden ratio. After
/// each sweep over the views, total-variation denoising, bounds and support are applied (Sidky & Pan, Phys. Med. Biol.
/// 53 (2008) 4777, with a proximal step in place of their gradient steps). Reports its progress. The result does not
/// depend on the number of threads. Needs 56 bytes per node.
/// @param grid  at least 2 nodes along each axis, not periodic
/// @throws SetupError   for settings or grids that are out of range
/// @throws DataError    for fewer than three views, lines and values that differ in number, or views without a common
///                      part of the volume
/// @throws MemoryError, Interrupted
VolumeReconstruction reconstruct_volume(std::vector<ProjectedView> const& views, RegularGrid const& grid,
                                        SartSettings const& settings);

/// Relative L2 error, |value - truth| / |truth|, over all nodes [1]; infinite if the truth is zero.
double compute_relative_error(std::vector<double> const& value, std::vector<double> const& truth);

}  // namespace gladstone::tomography
