#include "analysis/correlation/lane_peaks.h"

#include <algorithm>
#include <cstdint>

#include "analysis/correlation/window_peak.h"

namespace gladstone::inline correlation {
namespace {

/// Samples of eight maxima and of their left, right, upper and lower neighbours. All samples of an unused lane are 1.
struct LaneSamples {
  FloatLanes centre = all_lanes(1.0f), beside[4] = {centre, centre, centre, centre};

  void read(int k, LanePlaneView const& view, PlanePeak<float> const& peak) {
    centre[k] = view(peak.x, peak.y);
    beside[0][k] = view(peak.x - 1, peak.y);
    beside[1][k] = view(peak.x + 1, peak.y);
    beside[2][k] = view(peak.x, peak.y - 1);
    beside[3][k] = view(peak.x, peak.y + 1);
  }
};

/// SIMD version of fit_gauss3().
struct LaneGauss3 {
  FloatLanes offset[2];  ///< along x and y [px]
  FloatLanes rise;       ///< peak height over the centre sample, at most largest_rise [1]
  /// Bit l is set if all samples of lane l are positive; the results of the other lanes are invalid.
  unsigned positive;

  explicit LaneGauss3(LaneSamples const& at) {
    FloatLanes const least = 1e-30f * at.centre;
    IntLanes all = at.centre > 0.0f;
    FloatLanes log_rise{};
    for (int axis = 0; axis < 2; ++axis) {
      FloatLanes const left = at.beside[2 * axis], right = at.beside[2 * axis + 1];
      all &= (left > 0.0f) & (right > 0.0f);
      FloatLanes const l = log_lanes(larger_lanes(left, least) / at.centre);
      FloatLanes const r = log_lanes(larger_lanes(right, least) / at.centre), curvature = l + r;
      IntLanes const down = curvature < 0.0f;
      FloatLanes const vertex = 0.5f * (l - r) / select_lanes(down, curvature, all_lanes(-1.0f));
      FloatLanes const within = larger_lanes(all_lanes(-1.0f), -larger_lanes(all_lanes(-1.0f), -vertex));
      offset[axis] = select_lanes(down, within, FloatLanes{});
      log_rise += 0.5f * offset[axis] * ((r - l) + curvature * offset[axis]);
    }
    FloatLanes const most = all_lanes(static_cast<float>(largest_rise));
    FloatLanes const factor = exp_lanes(-larger_lanes(-log_rise, -most));
    rise = -larger_lanes(-factor, -most);
    positive = bits_of_lanes(all);
  }
};

/// Replaces the heights of up to eight maxima of one window by the interpolated heights of refined_peak().
void refine(LanePlaneView const& view, PlanePeak<float>* peaks, int count) {
  LaneSamples samples;
  for (int k = 0; k < count; ++k) samples.read(k, view, peaks[k]);
  LaneGauss3 const fit(samples);
  for (int k = 0; k < count; ++k)
    peaks[k].height = (fit.positive >> k & 1u) != 0u
                          ? samples.centre[k] * fit.rise[k]
                          : refined_peak(view, peaks[k].x, peaks[k].y, peaks[k].height).height;
}

/// Returns whether the interpolated height of a maximum can reach `enough`. Along an axis, a Gaussian through
/// neighbours of relative heights a and b exceeds the sample by the factor exp(log(a/b)^2 / (8 |log(a b)|)), which is
/// at most (a b)^(-1/8) since neither is above 1. The eighth powers are compared, with a margin for rounding. If a
/// neighbour is not positive, largest_rise is the only bound.
/// @pre largest_rise times the sample reaches `enough`
bool can_reach(LanePlaneView const& view, PlanePeak<float> const& peak, float enough) {
  float const v = peak.height;
  if (v >= enough) return true;
  float const left = view(peak.x - 1, peak.y), right = view(peak.x + 1, peak.y);
  float const above = view(peak.x, peak.y - 1), below = view(peak.x, peak.y + 1);
  if (!(std::min(std::min(left, right), std::min(above, below)) > 0.0f)) return true;
  float const part = 1.0f / v, beside = left * part * (right * part) * (above * part) * (below * part);
  float const ratio = v / enough, square = ratio * ratio, fourth = square * square;
  return !(1.001f * fourth * fourth < beside);
}

/// Inserts v into the sorted list of the three largest values, for scalars or for all lanes of a SIMD vector.
template <class T, class Larger, class Smaller>
void take_in(T (&largest)[3], T v, Larger const& larger, Smaller const& smaller) {
  for (T& place : largest) {
    T const rest = smaller(place, v);
    place = larger(place, v);
    v = rest;
  }
}

/// Returns the third largest of positive numbers; 0 if there are fewer. The array must be padded with zeros to whole
/// vectors.
float third_largest(float const* numbers, std::size_t count) {
  FloatLanes by_lane[3]{};
  for (std::size_t k = 0; k < count; k += lane_count)
    take_in(by_lane, load_lanes(numbers + k), larger_lanes, smaller_lanes);
  float largest[3]{};
  for (FloatLanes const& lanes : by_lane)
    for (int l = 0; l < lane_count; ++l)
      take_in(
          largest, lanes[l], [](float a, float b) { return a > b ? a : b; },
          [](float a, float b) { return a < b ? a : b; });
  return largest[2];
}

}  // namespace

LanePeaks::LanePeaks(InterrogationJob const& job, bool decreases_with_shift)
    : job_(job), decreases_with_shift_(decreases_with_shift) {
  std::size_t const count = static_cast<std::size_t>(2 * job.search_radius_px + 1);
  found_.resize((count + 7) / 8 * 8);
  // Two maxima are never adjacent.
  std::size_t const most = (count + 1) / 2 * ((count + 1) / 2);
  for (auto& list : maxima_) list.resize(most);
  for (auto& list : heights_) list.resize(most + lane_count);
  for (auto& row : highest_) row.resize(count);
}

/// Finds maxima like is_maximum(), in all lanes: the samples of the row above and the left neighbour must be lower than
/// the maximum; the right neighbour and the row below may be equal.
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
      FloatLanes const before = larger_lanes(larger_lanes((*above)[at], row[x - 1]), FloatLanes{});
      IntLanes const mask = (v > before) & (v >= larger_lanes((*below)[at], row[x + 1]));
      found_[at] = static_cast<unsigned char>(bits_of_lanes(mask));
    }
    // Process eight columns at a time: bit 8 x + lane of the mask belongs to column first + x.
    for (int first = 0; first < count; first += 8) {
      std::uint64_t bits;
      __builtin_memcpy(&bits, found_.data() + first, sizeof bits);
      for (; bits != 0; bits &= bits - 1) {
        int const bit = __builtin_ctzll(bits), x = first + bit / 8, lane = bit % 8;
        float const height = reinterpret_cast<float const*>(row + x)[lane];
        std::size_t const place = static_cast<std::size_t>(counts_[lane]++);
        maxima_[lane][place] = {x - radius, y, height};
        heights_[lane][place] = height;
      }
    }
    std::vector<FloatLanes>* const free = above;
    above = here;
    here = below;
    below = free;
  }
}

/// Returns the third highest sample of the maxima that are not close to each other; 0 if there are fewer.
float LanePeaks::third_highest(int lane) const {
  std::size_t const count = static_cast<std::size_t>(counts_[lane]);
  PlanePeak<float> const* const maxima = maxima_[lane].data();
  PeakList<float> highest;
  int as_high = 0;  // number of maxima at least as high as the third one; more than three if maxima are equally high
  float const third = third_largest(heights_[lane].data(), count);
  visit_high(lane, third, [&](PlanePeak<float> const& peak) {
    if (as_high++ < PeakList<float>::capacity) highest.peak[highest.count++] = peak;
  });
  auto const& [a, b, c] = highest.peak;
  if (as_high == PeakList<float>::capacity && !are_close(a, b) && !are_close(a, c) && !are_close(b, c)) return third;
  highest = {};
  for (std::size_t k = 0; k < count; ++k)
    if (can_enter(highest, maxima[k].height)) insert_peak(highest, maxima[k]);
  return highest.count == PeakList<float>::capacity ? highest.peak[2].height : 0.0f;
}

/// Calls visit for the maxima of a lane whose sample is at least `least`, in reading order.
template <class Visit>
void LanePeaks::visit_high(int lane, float least, Visit const& visit) const {
  int const count = counts_[lane];
  for (int first = 0; first < count; first += lane_count) {
    unsigned bits = bits_of_lanes(load_lanes(heights_[lane].data() + first) >= least);
    if (count - first < lane_count) bits &= (1u << (count - first)) - 1u;
    for (; bits != 0; bits &= bits - 1) visit(maxima_[lane][static_cast<std::size_t>(first + __builtin_ctz(bits))]);
  }
}

/// Ranks the peaks of one window as find_peaks() does, interpolating eight maxima at a time. A maximum that is lower
/// than three others can neither be one of the three highest peaks nor remove one of them, and is therefore skipped.
/// The search is repeated without this limit if fewer than three peaks are found.
PeakList<float> LanePeaks::rank(LanePlane const& plane, int lane) {
  LanePlaneView const view{plane, lane};
  std::fill_n(heights_[lane].data() + counts_[lane], lane_count, 0.0f);
  PeakList<float> found;
  for (float least = third_highest(lane);; least = 0.0f) {
    // lower limit of the height, such that the candidates of prefer_nearest() are also found
    float const enough = static_cast<float>(ambiguous_height_ratio) * least;
    found = {};
    refined_.clear();
    visit_high(lane, enough / static_cast<float>(largest_rise), [&](PlanePeak<float> const& peak) {
      if (can_reach(view, peak, enough)) refined_.push_back(peak);
    });
    for (std::size_t k = 0; k < refined_.size(); k += lane_count)
      refine(view, refined_.data() + k, static_cast<int>(std::min<std::size_t>(lane_count, refined_.size() - k)));
    for (PlanePeak<float> const& peak : refined_)
      if (peak.height >= least && can_enter(found, peak.height)) insert_peak(found, peak);
    bool const sure = found.count == PeakList<float>::capacity && found.peak[found.count - 1].height >= least;
    if (least == 0.0f || sure) break;
  }
  prefer_nearest(view, job_.search_radius_px, found, [&](auto const& visit) {
    for (PlanePeak<float> const& peak : refined_) visit(peak);
  });
  return found;
}

/// Measures the peak of one lane by any subpixel fit. Also used for three-point Gaussian fits in which a sample is not
/// positive.
MeasuredPeak LanePeaks::measure(LaneCorrelation const& work, LanePlaneView const& plane, int x, int y) const {
  if (!decreases_with_shift_) return fitted_peak(job_.fit, plane, x, y);
  return fitted_peak(job_.fit, plane, x, y, work.weights_x(), work.windows().column(plane.lane), work.weights_y(),
                     work.windows().row_of(plane.lane));
}

/// Measures the peak of rank p in each of the windows.
void LanePeaks::measure_all(LaneCorrelation const& work, LanePlane const& plane, int p, PeakList<float> const* found,
                            WindowCorrelation* results) const {
  LaneSamples samples;
  FloatLanes down[3], across[3];  // shift_attenuation() at the shifts one pixel before, at and one pixel after the peak
  for (FloatLanes* factor : {down, across}) std::fill_n(factor, 3, all_lanes(1.0f));
  for (int lane = 0; lane < lane_count; ++lane) {
    if (p >= found[lane].count) continue;
    PlanePeak<float> const& peak = found[lane].peak[p];
    samples.read(lane, {plane, lane}, peak);
    if (!decreases_with_shift_) continue;
    int const column = work.windows().column(lane), row = work.windows().row_of(lane);
    for (int i = -1; i <= 1; ++i) {
      across[i + 1][lane] = static_cast<float>(work.weights_x().shift_attenuation(column, peak.x + i));
      down[i + 1][lane] = static_cast<float>(work.weights_y().shift_attenuation(row, peak.y + i));
    }
  }
  samples.beside[0] /= across[0] * down[1];
  samples.beside[1] /= across[2] * down[1];
  samples.beside[2] /= across[1] * down[0];
  samples.beside[3] /= across[1] * down[2];
  samples.centre /= across[1] * down[1];
  LaneGauss3 const fit(samples);
  FloatLanes const height = samples.centre * fit.rise;
  bool const lanes_fit = job_.fit == fit_gauss3;
  for (int lane = 0; lane < lane_count; ++lane) {
    if (p >= found[lane].count) continue;
    PlanePeak<float> const& peak = found[lane].peak[p];
    bool const fitted = lanes_fit && (fit.positive >> lane & 1u) != 0u;
    MeasuredPeak const measured = fitted ? MeasuredPeak{{static_cast<double>(peak.x) + fit.offset[0][lane],
                                                         static_cast<double>(peak.y) + fit.offset[1][lane]},
                                                        height[lane]}
                                         : measure(work, {plane, lane}, peak.x, peak.y);
    results[lane].shift[static_cast<std::size_t>(p)] = measured.shift;
    results[lane].coefficient[static_cast<std::size_t>(p)] = measured.coefficient;
  }
}

void LanePeaks::pick(LaneCorrelation const& work, LanePlane const& plane, WindowCorrelation::Outcome const* outcome,
                     int count, WindowCorrelation* results) {
  find_maxima(plane);
  PeakList<float> found[lane_count];
  int most = 0;
  for (int lane = 0; lane < count; ++lane) {
    WindowCorrelation& result = results[lane];
    result.outcome = outcome[lane];
    if (result.outcome != WindowCorrelation::Outcome::measured) continue;
    PeakList<float> const& peaks = found[lane] = rank(plane, lane);
    most = std::max(most, peaks.count);
    result.peaks = peaks.count;
    if (peaks.count == 0) result.outcome = WindowCorrelation::Outcome::no_peak;
    if (peaks.count > 0)
      result.peak_ratio = peak_ratio(peaks.peak[0].height, peaks.peak[1].height, peaks.peak[2].height);
  }
  for (int p = 0; p < most; ++p) measure_all(work, plane, p, found, results);
}

}  // namespace gladstone::inline correlation
