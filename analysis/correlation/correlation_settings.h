#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/preparation/frame_preparation.h"
#include "render/base/vec.h"

namespace gladstone::inline correlation {

/// Table [correlate.tracking] of a setup: parameters of methods that track dots.
struct TrackingTable {
  std::optional<double> diameter_px;  ///< e^-2 diameter of a typical dot image [px]; none: estimated from the frames
  std::string polarity = "auto";      ///< "bright" or "dark" dots; "auto": that of the largest contrast
  std::string shape = "round";        ///< dot images: "round" or "elliptic" Gaussians
  /// Largest deviation of a dot from its predicted displacement [px]; none: 0.75 times the mean spacing of the dots.
  std::optional<double> search_radius_px;
  /// Upper bound of the deviation from the prediction, known in advance [px]; none: aliases beyond the search radius
  /// make a match ambiguous.
  std::optional<double> displacement_bound_px;
  std::string output = "grid";  ///< vectors: "grid" of the last pass, or "scattered", one per dot
};

/// Table [correlate] of a setup: parameters of the displacement measurement.
struct CorrelationSettings {
  std::vector<int> window_px{64, 32, 24, 20};  ///< nominal window of each pass [px]; even, 4 .. 512, not increasing
  double overlap = 0.6;                        ///< fraction of the window side shared with the next window, [0, 0.95]
  std::string method = "scc";                  ///< name of a method: one of correlation_methods()
  std::string subpixel = "gauss3";             ///< name of a sub-pixel fit: one of subpixel_fits()
  std::string weighting = "gaussian";          ///< "gaussian" over twice the window, or "uniform" over the window
  std::string deformation =
      "quintic";         ///< interpolation of the deformed images: B-spline, "cubic" or "quintic", or windowed "sinc"
  int final_passes = 1;  ///< number of runs of the last pass, 1 .. 5; more runs amplify fine detail and noise
  /// Largest number of additional runs of the last of several passes where displacement gradients are steep, 0 .. 20.
  int steep_passes = 8;
  std::optional<double> max_displacement_px;     ///< largest displacement along either axis, (0, 512]; none: limited by
                                                 ///< the window sizes only
  std::optional<double> median_threshold = 2.0;  ///< median residual above which a vector is spurious; none: no test
  double median_epsilon_px = 0.2;                ///< noise level epsilon in the median residual [px]
  /// Normalised median residual of the total displacement above which a vector is spurious if its window also
  /// correlates worse than its neighbours. Applied in the last of several passes; none: no test.
  std::optional<double> displacement_threshold = 2.0;
  std::optional<double> least_peak_ratio;   ///< lowest peak ratio of a vector of the last pass, >= 1; none: no test
  std::optional<double> least_correlation;  ///< lowest correlation coefficient of a vector's peak, [0, 1]; none: no
                                            ///< test
  bool replace = true;  ///< true: spurious vectors of the last pass are replaced; false: they are invalid
  /// Estimator of sigma_px: one of uncertainty_methods(), "none", or "auto" (in a setup the default), which estimates
  /// none until choose_uncertainty() has replaced it.
  std::string uncertainty = "none";
  /// Peak ratio from which a vector of the first pass may deviate from its neighbours, see has_reliable_correlation();
  /// none: every deviating vector is spurious.
  std::optional<double> trusted_peak_ratio = 2.0;
  TrackingTable tracking;  ///< parameters of method "tracking"
  /// Known positions of the dots of a BOS target in frame A [px], used by method "tracking"; not part of a setup.
  std::vector<Vec2d> known_dots_px;
  FramePreparation preparation;  ///< preprocessing; correlators expect preprocessed frames

  /// Returns true if vectors are at the dots instead of the grid of the last pass.
  bool gives_scattered_vectors() const;
  /// Returns true if `uncertainty` names a method.
  bool estimates_uncertainty() const { return uncertainty != "none" && uncertainty != "auto"; }
};

/// Checks that the windows fit into an image of the given size. Returns the problem as "problem (reason); suggestion";
/// empty if there is none.
std::string window_problem(CorrelationSettings const& settings, int columns, int rows);

}  // namespace gladstone::inline correlation
