#pragma once

#include <cmath>
#include <type_traits>

#include "analysis/correlation/subpixel_peak.h"
#include "render/base/host_device.h"

/// Peaks of a correlation plane, for the CPU and the CUDA kernels. Peaks are ranked by their interpolated heights. If
/// the maximum of a peak (a Gaussian of 1 px) is half a pixel away from the nearest samples along an axis, the highest
/// sample is 12 % lower than the maximum. Ranking by samples would therefore favour peaks near whole pixels, for
/// example aliases of a regular pattern.
namespace gladstone::inline correlation {

/// Correlation plane in the order of an inverse transform: shift (dx, dy) in row dy mod size, column dx mod size.
template <class T>
struct PlaneView {
  T const* value;
  int size;
  int stride;  ///< distance between the values of neighbouring columns in memory [values]: 2 for two interleaved planes

  /// @pre -size <= dx, dy < size
  GLADSTONE_HD T operator()(int dx, int dy) const {
    int const x = dx < 0 ? dx + size : dx;
    int const y = dy < 0 ? dy + size : dy;
    return value[(static_cast<long long>(y) * size + x) * stride];
  }
};

/// Local maximum of a correlation plane.
template <class T>
struct PlanePeak {
  int x = 0;  ///< shift of its highest sample [px]
  int y = 0;
  T height{};  ///< interpolated height between the samples
};

/// Highest local maxima of a correlation plane.
template <class T>
struct PeakList {
  static constexpr int capacity = 3;
  PlanePeak<T> peak[capacity];  ///< peaks in descending order of height, except for a peak moved to the front by
                                ///< prefer_nearest()
  int count = 0;
};

/// Returns whether v, the plane's value at (x, y), exceeds its eight neighbours; of equal samples, the first in reading
/// order is the maximum.
template <class Plane, class T>
GLADSTONE_HD bool is_maximum(Plane const& plane, int x, int y, T v) {
  return v > plane(x - 1, y - 1) && v > plane(x, y - 1) && v > plane(x + 1, y - 1) && v > plane(x - 1, y) &&
         v >= plane(x + 1, y) && v >= plane(x - 1, y + 1) && v >= plane(x, y + 1) && v >= plane(x + 1, y + 1);
}

/// Upper bound of a peak's interpolated height over its highest sample: the value for a Gaussian of 0.6 px (the
/// correlation of pixel-sized points) whose maximum is half a pixel away from the highest sample along both axes.
/// Larger ratios are caused by noise in the neighbouring samples.
constexpr double largest_rise = 2.0;

/// Interpolated position and height of a maximum, from three samples along each axis.
template <class T>
struct RefinedPeak {
  T x, y;
  T height;
};

/// Interpolates a maximum of the plane. @param v  the plane's value at its maximum (x, y), positive
template <class Plane, class T>
GLADSTONE_HD RefinedPeak<T> refined_peak(Plane const& plane, int x, int y, T v) {
  using std::exp;
  PeakBetweenSamples<T> const across = gaussian_peak<T>(plane(x - 1, y), v, plane(x + 1, y));
  PeakBetweenSamples<T> const down = gaussian_peak<T>(plane(x, y - 1), v, plane(x, y + 1));
  T const rise = T(exp(across.log_rise + down.log_rise)), most = T(largest_rise);
  return {T(x) + across.offset, T(y) + down.offset, v * (rise < most ? rise : most)};
}

/// Returns whether a peak of a given height is high enough to be inserted into the list.
template <class T>
GLADSTONE_HD bool can_enter(PeakList<T> const& found, T height) {
  return found.count < PeakList<T>::capacity || height > found.peak[PeakList<T>::capacity - 1].height;
}

/// Returns whether two peaks are less than three pixels from each other on both axes, so that only the higher one
/// counts.
template <class T>
GLADSTONE_HD bool are_close(PlanePeak<T> const& a, PlanePeak<T> const& b) {
  constexpr int apart = 3;
  int const dx = a.x - b.x, dy = a.y - b.y;
  return dx < apart && -dx < apart && dy < apart && -dy < apart;
}

/// Inserts a local maximum into the list unless a higher maximum is close to it, and removes lower maxima that are
/// close to it. Maxima must be inserted in reading order. @pre can_enter(found, candidate.height)
template <class T>
GLADSTONE_HD void insert_peak(PeakList<T>& found, PlanePeak<T> const& candidate) {
  int place = 0;
  for (; place < found.count && !(candidate.height > found.peak[place].height); ++place)
    if (are_close(found.peak[place], candidate)) return;
  // Keep the higher peaks, then the candidate, then lower peaks that are not close to it, up to the capacity.
  PeakList<T> next;
  for (int k = 0; k < place; ++k) next.peak[next.count++] = found.peak[k];
  next.peak[next.count++] = candidate;
  for (int k = place; k < found.count && next.count < PeakList<T>::capacity; ++k)
    if (!are_close(found.peak[k], candidate)) next.peak[next.count++] = found.peak[k];
  found = next;
}

/// Height ratio above which two peaks are considered equally high. In windows of a regular pattern, the heights of
/// aliases differ by up to this ratio, because each alias lacks different dots at the window border and the three-point
/// Gaussian does not match the peak shape exactly.
constexpr double ambiguous_height_ratio = 0.9;

/// Returns whether no higher maximum is close to a peak, so that the peak is not the shoulder of another one. Of equal
/// maxima, the first in reading order counts as the higher.
template <class Plane, class T>
GLADSTONE_HD bool is_dominant_maximum(Plane const& plane, int radius, PlanePeak<T> const& peak) {
  for (int y = peak.y - 2; y <= peak.y + 2; ++y)
    for (int x = peak.x - 2; x <= peak.x + 2; ++x) {
      bool const before = y < peak.y || (y == peak.y && x < peak.x);
      if (x < -radius || x > radius || y < -radius || y > radius || (x == peak.x && y == peak.y)) continue;
      T const v = plane(x, y);
      if (!(T(largest_rise) * v >= peak.height) || !is_maximum(plane, x, y, v)) continue;
      T const height = refined_peak(plane, x, y, v).height;
      if (height > peak.height || (before && height == peak.height)) return false;
    }
  return true;
}

/// Moves the peak nearest to shift 0 to the front of the list, among all maxima of nearly the greatest height. This
/// peak is the most likely one, because aliases of a regular pattern are equally high, whereas the displacement, or the
/// residual after a predictor, is usually small.
/// @param for_each_maximum  calls its argument with every positive local maximum in reading order
template <class Plane, class T, class Maxima>
GLADSTONE_HD void prefer_nearest(Plane const& plane, int radius, PeakList<T>& found, Maxima const& for_each_maximum) {
  T const enough = T(ambiguous_height_ratio) * found.peak[0].height;
  if (found.count < 2 || found.peak[1].height < enough) return;
  auto const distance = [&](PlanePeak<T> const& peak) {
    RefinedPeak<T> const at = refined_peak(plane, peak.x, peak.y, plane(peak.x, peak.y));
    return at.x * at.x + at.y * at.y;
  };
  PlanePeak<T> nearest = found.peak[0];
  T least = distance(nearest);
  for_each_maximum([&](PlanePeak<T> const& peak) {
    if (peak.height < enough) return;
    T const here = distance(peak);
    if (!(here < least) || !is_dominant_maximum(plane, radius, peak)) return;
    least = here;
    nearest = peak;
  });
  int place = 0;
  while (place < found.count - 1 && (found.peak[place].x != nearest.x || found.peak[place].y != nearest.y)) ++place;
  for (; place > 0; --place) found.peak[place] = found.peak[place - 1];
  found.peak[0] = nearest;
}

/// Calls visit for every positive local maximum with |dx|, |dy| <= radius, in reading order; skips maxima that are
/// certainly too low.
/// @param could_pass  returns whether a peak of at most that height is of interest
template <class Plane, class Visit, class CouldPass>
GLADSTONE_HD void visit_maxima(Plane const& plane, int radius, Visit const& visit, CouldPass const& could_pass) {
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) {
      auto const v = plane(x, y);
      using T = std::remove_const_t<decltype(v)>;
      if (v > T(0) && could_pass(T(largest_rise) * v) && is_maximum(plane, x, y, v))
        visit(PlanePeak<T>{x, y, refined_peak(plane, x, y, v).height});
    }
}

/// Visits the maxima from which prefer_nearest() chooses.
template <class Plane, class T, class Visit>
GLADSTONE_HD void visit_candidate_peaks(Plane const& plane, int radius, PeakList<T> const& found, Visit const& visit) {
  T const enough = T(ambiguous_height_ratio) * found.peak[0].height;
  visit_maxima(plane, radius, visit, [enough](T height) { return height >= enough; });
}

/// Finds the positive local maxima with |dx|, |dy| <= radius that have the greatest interpolated heights. Of maxima
/// closer than three pixels on both axes only the higher counts, so that a noisy peak is not its own secondary peak; of
/// maxima of equal height, the first in reading order counts. Finally applies prefer_nearest().
/// @pre radius + 1 < size/2
template <class T>
GLADSTONE_HD PeakList<T> find_peaks(PlaneView<T> plane, int radius) {
  PeakList<T> found;
  visit_maxima(
      plane, radius,
      [&](PlanePeak<T> const& peak) {
        if (can_enter(found, peak.height)) insert_peak(found, peak);
      },
      [&](T height) { return can_enter(found, height); });
  prefer_nearest(plane, radius, found, [&](auto const& visit) { visit_candidate_peaks(plane, radius, found, visit); });
  return found;
}

}  // namespace gladstone::inline correlation
