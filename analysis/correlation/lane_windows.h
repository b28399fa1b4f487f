#pragma once

#include <vector>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/float_lanes.h"
#include "analysis/correlation/interrogation_job.h"
#include "analysis/correlation/known_tiles.h"
#include "analysis/correlation/window_means.h"

namespace gladstone {

/// The two real pictures of a window whose correlation is wanted; A and B are the mean-free frames, w the weights.
enum class WindowTerm {
  frames,             ///< w A and w B
  reference_energy,   ///< w A^2 and w
  flow_energy,        ///< w and w B^2
  search,             ///< w^2 A and B as it is, over the search range beyond the window, too
  search_energy,      ///< w^2 and B^2 over that range
  search_back,        ///< A as it is over that range, and w^2 B
  search_back_energy  ///< A^2 over that range, and w^2
};

/// Eight windows of a grid side by side: their pixels, weighted and with the weighted mean taken off, row by row.
class LaneWindows {
 public:
  /// @param with_margin whether rows are read beyond the weights, too
  LaneWindows(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y, KnownTiles const& tiles,
              WindowMeans const& means, bool with_margin);

  /// Side of the pixels that a window reads [px].
  int side() const { return side_ + 2 * margin_; }
  /// Looks up the windows begin .. begin + count - 1, and takes their means. Lanes from `count` on repeat the last.
  void place(std::size_t begin, int count);
  /// Row j of side() of all eight: reference as real, flow as imaginary parts. Energies of w A and w B are gathered on
  /// the way of the frames and the search. `out` has room for whole lanes: side() and seven more.
  void row(int j, WindowTerm term, ComplexLanes* out);
  /// Outcome of a window that cannot be correlated; measured where it can, so far.
  WindowCorrelation::Outcome outcome(int lane) const { return outcome_[lane]; }
  /// What makes a plane of unnormalised transforms a correlation coefficient, once all rows were read; 0 where there is
  /// nothing to correlate. @param size of the transform
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
  int offset_;  // of the pixels that count from the first of the support
  int side_;
  int margin_ = 0;  // search range on either side
  int padded_;      // side with the margin, up to whole lanes
  Source source_[lane_count];
  int column_[lane_count], row_[lane_count];
  WindowCorrelation::Outcome outcome_[lane_count];
  FloatLanes mean_reference_, mean_flow_, reference_, flow_, core_reference_, core_flow_;
  std::vector<FloatLanes> weight_x_, weight_y_;  // along x with the margin
  bool gathered_ = false;                        // whether weight_x_, weight_y_ are those of uncut windows in all lanes
  std::vector<float> patch_[lane_count];
};

}  // namespace gladstone
