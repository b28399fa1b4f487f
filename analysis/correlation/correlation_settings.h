#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/preparation/frame_preparation.h"
#include "render/base/setup_table.h"

namespace gladstone {

/// Table [correlate] of a setup: how displacement is measured.
struct CorrelationSettings {
  std::vector<int> window_px{64, 32, 24, 20};  ///< nominal window of every pass [px]; even, 4 .. 512, never growing
  double overlap = 0.6;                        ///< part of a window shared with the next, [0, 0.95]
  std::string method = "scc";                  ///< a name of correlation_methods()
  std::string subpixel = "gauss3";             ///< a name of subpixel_fits()
  std::string weighting = "gaussian";          ///< "gaussian" over twice the window, or "uniform" over the window
  std::string deformation =
      "quintic";         ///< of the images between passes: B-splines, "cubic" or "quintic", or a windowed "sinc"
  int final_passes = 1;  ///< times the last pass is run, 1 .. 5; more sharpen detail and noise alike
  std::optional<double> max_displacement_px;     ///< largest along either axis, (0, 512]; none: what the windows permit
  std::optional<double> median_threshold = 2.0;  ///< normalised median residual of a spurious vector; none: no test
  double median_epsilon_px = 0.2;                ///< noise level in that residual [px]
  /// The same of whole displacements, of vectors of the last of several passes that correlate worse than their
  /// neighbours; none: no test
  std::optional<double> displacement_threshold = 2.0;
  std::optional<double> least_peak_ratio;   ///< below it a vector of the last pass is spurious, >= 1; none: no test
  std::optional<double> least_correlation;  ///< the same for the coefficient of its peak, 0 .. 1
  bool replace = true;                      ///< spurious vectors of the last pass; else they are invalid
  /// How sigma_px is estimated: a name of uncertainty_methods(), or "none".
  std::string uncertainty = "none";
  /// Peak ratio from which a vector of the first pass may differ from its neighbours (is_trusted()); none: no vector
  /// may
  std::optional<double> trusted_peak_ratio = 2.0;
  FramePreparation preparation;  ///< what is done to the frames before; correlators take them as they then are
};

/// Reads the table [correlate]; problems are collected in its document.
CorrelationSettings read_correlation_settings(SetupTable table);

/// Why these settings do not suit an image of that size (a window larger than the image), as
/// "problem (why); suggestion"; empty where they do.
std::string window_problem(CorrelationSettings const& settings, int columns, int rows);

}  // namespace gladstone
