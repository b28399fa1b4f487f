#include "analysis/correlation/lane_peaks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "analysis/correlation/window_peak.h"

namespace gladstone {
namespace {

/// Puts the heights between the samples, as refined_peak() has them, into up to eight maxima of one window.
void refine(LanePlaneView const& view, PlanePeak<float>* peaks, int count) {
  FloatLanes centre = all_lanes(1.0f), beside[4] = {centre, centre, centre, centre};
  for (int k = 0; k < count; ++k) {
    centre[k] = peaks[k].height;
    beside[0][k] = view(peaks[k].x - 1, peaks[k].y);
    beside[1][k] = view(peaks[k].x + 1, peaks[k].y);
    beside[2][k] = view(peaks[k].x, peaks[k].y - 1);
    beside[3][k] = view(peaks[k].x, peaks[k].y + 1);
  }
  FloatLanes const least = 1e-30f * centre;
  IntLanes positive = beside[0] > 0.0f;
  FloatLanes logarithm[4];
  for (int i = 0; i < 4; ++i) {
    positive &= beside[i] > 0.0f;
    logarithm[i] = log_lanes(larger_lanes(beside[i], least) / centre);
  }
  FloatLanes rise{};
  for (int i = 0; i < 4; i += 2) {
    FloatLanes const l = logarithm[i], r = logarithm[i + 1], curvature = l + r;
    FloatLanes const offset = select_lanes(
        curvature < 0.0f, 0.5f * (l - r) / select_lanes(curvature < 0.0f, curvature, all_lanes(-1.0f)), FloatLanes{});
    rise += 0.5f * offset * ((r - l) + curvature * offset);
  }
  FloatLanes const most = all_lanes(static_cast<float>(largest_rise));
  FloatLanes const factor = exp_lanes(select_lanes(rise < 2.0f, rise, all_lanes(2.0f)));
  FloatLanes const height = centre * select_lanes(factor < most, factor, most);
  unsigned const bits = bits_of_lanes(positive);
  for (int k = 0; k < count; ++k)
    peaks[k].height =
        (bits >> k & 1u) != 0u ? height[k] : refined_peak(view, peaks[k].x, peaks[k].y, peaks[k].height).height;
}

}  // namespace

LanePeaks::LanePeaks(InterrogationJob const& job, bool falls_off) : job_(job), falls_off_(falls_off) {
  std::size_t const count = static_cast<std::size_t>(2 * job.search_radius_px + 1);
  found_.resize((count + 7) / 8 * 8);
  // no two maxima are neighbours
  for (auto& list : maxima_) list.resize((count + 1) / 2 * ((count + 1) / 2));
  for (auto& row : highest_) row.resize(count);
}

/// is_maximum() in all lanes: what comes before, the row above and the left neighbour, must be lower, what comes after
/// may be as high.
void LanePeaks::find_maxima(LanePlane const& plane) {
  std::fill_n(counts_, lane_count, 0);
  int const radius = job_.search_radius_px, count = 2 * radius + 1;
  auto const highest_of_three = [&](int y, FloatLanes* to) {
    FloatLanes const* const row = plane.row(y) - radius;
    for (int x = 0; x < count; ++x) to[x] = larger_lanes(larger_lanes(row[x - 1], row[x]), row[x + 1]);
  };
  std::vector<FloatLanes>*above = &highest_[0], *here = &highest_[1], *below = &highest_[2];
  highest_of_three(-radius - 1, above->data());
  highest_of_three(-radius, here->data());
  for (int y = -radius; y <= radius; ++y) {
    highest_of_three(y + 1, below->data());
    FloatLanes const* const row = plane.row(y) - radius;
    for (int x = 0; x < count; ++x) {
      FloatLanes const v = row[x];
      std::size_t const at = static_cast<std::size_t>(x);
      IntLanes const mask =
          (v > 0.0f) & (v > row[x - 1]) & (v >= row[x + 1]) & (v > (*above)[at]) & (v >= (*below)[at]);
      found_[at] = static_cast<unsigned char>(bits_of_lanes(mask));
    }
    // eight places at a time: bit 8 x + lane
    for (int first = 0; first < count; first += 8) {
      std::uint64_t bits;
      __builtin_memcpy(&bits, found_.data() + first, sizeof bits);
      for (; bits != 0; bits &= bits - 1) {
        int const bit = __builtin_ctzll(bits), x = first + bit / 8, lane = bit % 8;
        maxima_[lane][static_cast<std::size_t>(counts_[lane]++)] = {x - radius, y,
                                                                    reinterpret_cast<float const*>(row + x)[lane]};
      }
    }
    std::vector<FloatLanes>* const free = above;
    above = here;
    here = below;
    below = free;
  }
}

/// Heights between the samples as refined_peak() has them, eight maxima of one window at a time, then find_peaks().
PeakList<float> LanePeaks::rank(LanePlane const& plane, int lane) {
  std::vector<PlanePeak<float>>& maxima = maxima_[lane];
  LanePlaneView const view{plane, lane};
  PeakList<float> found;
  std::size_t const all = static_cast<std::size_t>(counts_[lane]);
  std::size_t next = 0, kept = 0;
  while (next < all) {
    PlanePeak<float> group[lane_count];
    int count = 0;
    for (; next < all && count < lane_count; ++next)
      if (can_enter(found, static_cast<float>(largest_rise) * maxima[next].height)) group[count++] = maxima[next];
    refine(view, group, count);
    for (int k = 0; k < count; ++k) {
      maxima[kept++] = group[k];
      if (can_enter(found, group[k].height)) insert_peak(found, group[k]);
    }
  }
  prefer_nearest(view, job_.search_radius_px, found, [&](auto const& visit) {
    for (std::size_t k = 0; k < kept; ++k) visit(maxima[k]);
  });
  return found;
}

MeasuredPeak LanePeaks::measure(LaneCorrelation const& work, LanePlaneView const& plane, int lane, int x, int y) const {
  if (!falls_off_) return fitted_peak(job_.fit, plane, x, y);
  return fitted_peak(job_.fit, plane, x, y, work.weights_x(), work.windows().column(lane), work.weights_y(),
                     work.windows().row_of(lane));
}

void LanePeaks::pick(LaneCorrelation& work, LanePlane const& plane, int count, WindowCorrelation* results) {
  find_maxima(plane);
  for (int lane = 0; lane < count; ++lane) {
    WindowCorrelation& result = results[lane];
    result.outcome = work.windows().outcome(lane);
    if (result.outcome != WindowCorrelation::Outcome::measured) continue;
    PeakList<float> const found = rank(plane, lane);
    result.peaks = found.count;
    if (found.count == 0) result.outcome = WindowCorrelation::Outcome::no_peak;
    LanePlaneView const view{plane, lane};
    for (int p = 0; p < found.count; ++p) {
      MeasuredPeak const peak = measure(work, view, lane, found.peak[p].x, found.peak[p].y);
      result.shift[p] = peak.shift;
      result.coefficient[p] = peak.coefficient;
    }
    if (found.count > 0)
      result.peak_ratio = peak_ratio(found.peak[0].height, found.peak[1].height, found.peak[2].height);
  }
}

}  // namespace gladstone
