#pragma once

#include <vector>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/float_lanes.h"
#include "analysis/correlation/interrogation_job.h"
#include "analysis/correlation/known_tiles.h"
#include "analysis/correlation/window_means.h"

namespace gladstone::inline correlation {

/// Pair of real images of a window to be correlated. A and B are the frames without their means, w the weights.
enum class WindowTerm {
  frames,             ///< w A and w B
  reference_energy,   ///< w A^2 and w
  flow_energy,        ///< w and w B^2
  search,             ///< w^2 A, and B without weights over the window and the search range around it
  search_energy,      ///< w^2, and B^2 over the window and the search range
  search_back,        ///< A without weights over the window and the search range, and w^2 B
  search_back_energy  ///< A^2 over the window and the search range, and w^2
};

/// Pixels of eight windows of a grid in SIMD lanes, row by row, with the weighted mean subtracted and the weights
/// applied.
class LaneWindows {
 public:
  /// @param with_margin  whether rows include the search range around the window
  LaneWindows(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y, KnownTiles const& tiles,
              WindowMeans const& means, bool with_margin);

  /// Returns the side of the square of pixels that is read for each window [px].
  int side() const { return side_ + 2 * margin_; }
  /// Selects the windows begin .. begin + count - 1 and their means. Lanes from `count` on repeat the last window.
  void place(std::size_t begin, int count);
  /// Computes row j, 0 <= j < side(), of all eight windows: first image as real, second image as imaginary parts. For
  /// the terms `frames` and `search`, the energies of w A and w B are accumulated as well.
  /// @param out  side() values and seven more, since whole vectors are written
  void row(int j, WindowTerm term, ComplexLanes* out);
  /// Returns the outcome of a window that cannot be correlated; otherwise measured.
  WindowCorrelation::Outcome outcome(int lane) const { return outcome_[lane]; }
  /// Returns the factor that converts a plane of unnormalised transforms to correlation coefficients; 0 for windows
  /// that cannot be correlated. @param size  length of the transform
  /// @pre all rows have been read
  FloatLanes scale(int size);
  FloatLanes energy_reference() const { return reference_; }
  FloatLanes energy_flow() const { return flow_; }
  int column(int lane) const { return column_[lane]; }
  int row_of(int lane) const { return row_[lane]; }

 private:
  struct Source {
    float const* reference;
    float const* flow;
    int stride;
    float mean_reference, mean_flow;
  };
  void place_lane(int lane, std::size_t window);
  void copy_lane(int lane, int first_x, int first_y, float const* weight_x, float const* weight_y);
  void gather_weights();
  template <WindowTerm term>
  ComplexLanes row_of_term(int j, ComplexLanes* out) const;
  void gather_energies(int j, ComplexLanes const* row, ComplexLanes const& whole);

  InterrogationJob const& job_;
  AxisWeightsView x_, y_;
  KnownTiles const& tiles_;
  WindowMeans const& means_;
  int offset_;  // distance from the first pixel of the support to the first pixel with non-zero weight [px]
  int side_;
  int margin_ = 0;  // width of the search range on either side of the window; 0: not read [px]
  int padded_;      // side including the margin, rounded up to whole SIMD vectors [px]
  Source source_[lane_count];
  int column_[lane_count], row_[lane_count];
  WindowCorrelation::Outcome outcome_[lane_count];
  FloatLanes mean_reference_, mean_flow_, reference_, flow_, core_reference_, core_flow_;
  std::vector<FloatLanes> weight_x_, weight_y_;  // weights of the columns, including the margin, and of the rows
  // true: weight_x_ and weight_y_ contain the weights of windows inside the image
  bool gathered_ = false;
  std::vector<float> patch_[lane_count];
};

}  // namespace gladstone::inline correlation
