#pragma once

#include <functional>
#include <vector>

#include "analysis/correlation/lane_fourier.h"
#include "analysis/correlation/lane_windows.h"

namespace gladstone::inline correlation {

/// Modifies the cross spectrum of eight windows at the wave numbers (kx, ky), ky = 0 .. size - 1, in the order of the
/// transform: elements from ky = size/2 on have the frequency ky - size.
using SpectrumFilter = std::function<void(ComplexLanes* spectrum, int kx, int size)>;

/// Correlation planes of eight windows in SIMD lanes. The value at shift (dx, dy), |dx|, |dy| <= radius + 1, is in row
/// dy + radius + 1.
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

/// View of the correlation plane of the window in one SIMD lane.
struct LanePlaneView {
  LanePlane const& plane;
  int lane;
  float operator()(int dx, int dy) const { return reinterpret_cast<float const*>(&plane(dx, dy))[lane]; }
};

/// Correlates eight windows at a time, one per SIMD lane, by Fourier transforms. The transforms are long enough that
/// shifts up to the search radius do not wrap around for uniform windows. Gaussian windows do wrap around at their rim,
/// where the weight has decreased to exp(-pi).
class LaneCorrelation {
 public:
  LaneCorrelation(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y,
                  KnownTiles const& tiles, WindowMeans const& means, LaneFourier const& fourier, bool with_margin);

  /// Returns the length of the transforms for a job.
  static int transform_size(InterrogationJob const& job, bool with_margin);

  LaneWindows& windows() { return windows_; }
  LaneWindows const& windows() const { return windows_; }
  AxisWeightsView const& weights_x() const { return x_; }
  AxisWeightsView const& weights_y() const { return y_; }
  int size() const { return fourier_.size(); }
  /// Reads the pixels of the windows selected by windows().place(), and transforms their rows.
  void load(WindowTerm term);
  /// Computes the correlation planes of the loaded windows, multiplied by `scale`.
  /// @param filter  applied to the cross spectrum; empty: none
  void correlate(FloatLanes scale, SpectrumFilter const& filter, LanePlane& plane);

 private:
  void filter_columns(FloatLanes scale, SpectrumFilter const& filter, int reach);
  void make_rows(LanePlane& plane);

  AxisWeightsView x_, y_;
  LaneFourier const& fourier_;
  LaneWindows windows_;
  int pitch_;       // row stride of the spectra [ComplexLanes]
  int half_pitch_;  // row stride of the half spectra [ComplexLanes]
  std::vector<ComplexLanes> spectrum_, half_, line_, column_, mirror_, scratch_;
};

/// Computes the planes of the windows selected by work.windows().place(). The values of the planes must be correlation
/// coefficients, at most 1.
using MakePlane = void (*)(LaneCorrelation& work, LanePlane& plane);

/// Properties of a correlation method that computes planes.
struct PlaneMethod {
  MakePlane make;
  bool with_margin = false;  ///< whether the method reads the search range around the window
  /// Whether the planes of the method decrease with increasing shift like the autocorrelation of the weights.
  bool decreases_with_shift = true;
};

/// Returns the length of the transforms for the plane of a window without the search range around it.
/// @param radius  search radius [px]
int plane_transform_size(WindowWeighting weighting, int window_px, int radius);

/// Processes the planes of windows first .. first + count - 1; it may modify them.
using VisitPlanes = std::function<void(std::size_t first, int count, LaneCorrelation& work, LanePlane& plane)>;

/// Computes the planes of all windows of a job, eight at a time, on all threads.
/// @param make_visitor  creates one visitor per concurrent thread, so that visitors may own memory
void visit_planes(InterrogationJob const& job, PlaneMethod const& method,
                  std::function<VisitPlanes()> const& make_visitor);

/// Correlates all windows of a job by a plane method.
std::vector<WindowCorrelation> correlate_in_lanes(InterrogationJob const& job, PlaneMethod const& method);

}  // namespace gladstone::inline correlation
