#pragma once

#include <functional>
#include <span>
#include <vector>

#include "analysis/correlation/lane_fourier.h"
#include "analysis/correlation/lane_windows.h"

namespace gladstone {

/// Changes the cross spectrum of eight windows at the wave numbers (kx, 0 .. size - 1); its values stand in the order
/// of the transform, frequency ky - size from ky = size/2 on.
using SpectrumFilter = std::function<void(ComplexLanes* spectrum, int kx, int size)>;

/// Correlation planes of eight windows side by side: value of shift (dx, dy), |dx|, |dy| <= radius + 1, in row dy +
/// radius + 1.
class LanePlane {
 public:
  explicit LanePlane(int radius) : reach_(radius + 1), values_(static_cast<std::size_t>(side()) * side()) {}

  int reach() const { return reach_; }
  int side() const { return 2 * reach_ + 1; }
  FloatLanes* row(int dy) { return values_.data() + static_cast<std::size_t>(dy + reach_) * side() + reach_; }
  FloatLanes const* row(int dy) const {
    return values_.data() + static_cast<std::size_t>(dy + reach_) * side() + reach_;
  }
  FloatLanes& operator()(int dx, int dy) { return row(dy)[dx]; }
  FloatLanes const& operator()(int dx, int dy) const { return row(dy)[dx]; }

 private:
  int reach_;
  std::vector<FloatLanes> values_;
};

/// One lane of it.
struct LanePlaneView {
  LanePlane const& plane;
  int lane;
  float operator()(int dx, int dy) const { return reinterpret_cast<float const*>(&plane(dx, dy))[lane]; }
};

/// Correlates eight windows at a time by Fourier transforms in which every lane of a vector register holds another
/// window. A transform is long enough that shifts up to the search radius never wrap over uniform windows; Gaussian
/// ones have fallen to exp(-pi) at their rim, and wrap there.
class LaneCorrelation {
 public:
  LaneCorrelation(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y,
                  KnownTiles const& tiles, WindowMeans const& means, LaneFourier const& fourier, bool with_margin);

  /// Length of the transforms that a job needs.
  static int transform_size(InterrogationJob const& job, bool with_margin);

  LaneWindows& windows() { return windows_; }
  LaneWindows const& windows() const { return windows_; }
  InterrogationJob const& job() const { return job_; }
  AxisWeightsView const& weights_x() const { return x_; }
  AxisWeightsView const& weights_y() const { return y_; }
  int size() const { return fourier_.size(); }
  /// Reads the pixels of the windows that windows() was last placed on, and transforms their rows.
  void load(WindowTerm term);
  /// The planes of what was loaded, times `scale`. @param filter of the cross spectrum; empty: none
  void correlate(FloatLanes scale, SpectrumFilter const& filter, LanePlane& plane);

 private:
  void filter_columns(FloatLanes scale, SpectrumFilter const& filter, int reach);
  void make_rows(LanePlane& plane);

  InterrogationJob const& job_;
  AxisWeightsView x_, y_;
  LaneFourier const& fourier_;
  LaneWindows windows_;
  int pitch_;       // of rows of spectra
  int half_pitch_;  // of rows of half spectra
  std::vector<ComplexLanes> spectrum_, half_, line_, column_, mirror_, scratch_;
};

/// How a method makes the planes of the windows that work.windows() was placed on. They are to be correlation
/// coefficients, 1 at most.
using MakePlane = void (*)(LaneCorrelation& work, LanePlane& plane);

/// What distinguishes a method that works by planes.
struct PlaneMethod {
  MakePlane make;
  bool with_margin = false;  ///< reads the flow frame beyond the window
  bool falls_off = true;     ///< its planes fall off with the shift as the windows' common weight does
};

/// Least length of the transforms that give the plane of a window without the margin. @param radius of the search [px]
int plane_transform_size(WindowWeighting weighting, int window_px, int radius);

/// What is done with the planes of windows first .. first + count - 1.
/// They may be changed by it.
using VisitPlanes = std::function<void(std::size_t first, int count, LaneCorrelation& work, LanePlane& plane)>;

/// Makes the planes of all windows of a job, eight at a time, on all threads.
/// @param make_visitor called for each thread that works at a time, so that visitors may have memory of their own
void visit_planes(InterrogationJob const& job, PlaneMethod const& method,
                  std::function<VisitPlanes()> const& make_visitor);

/// Correlates all windows of a job by such a method.
std::vector<WindowCorrelation> correlate_in_lanes(InterrogationJob const& job, PlaneMethod const& method);

}  // namespace gladstone
