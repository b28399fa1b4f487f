#pragma once

#include "analysis/correlation/window_measurement.h"
#include "cuda/correlation/paired_plane.h"

namespace gladstone::cuda::inline correlation {

/// Correlation plane in shared memory, in rows of `pitch` values, with shift (0, 0) at `centre`.
template <int pitch>
struct CentredPlane {
  float const* centre;
  __device__ float operator()(int dx, int dy) const { return centre[dy * pitch + dx]; }
};

/// Lists the positive local maxima among the shifts with indices [begin, end), in reading order. The indices count the
/// shifts of the square of side 2 radius + 1 row by row. Called by one full warp.
/// @param begin  a multiple of 32
/// @return number of maxima
template <class Plane>
__device__ int list_maxima(Plane const& plane, int radius, int begin, int end, PlanePeak<float>* list) {
  int const lane = static_cast<int>(threadIdx.x % 32u);
  int const width = 2 * radius + 1, rows_per_step = 32 / width, columns_per_step = 32 % width;
  int y = (begin + lane) / width, x = (begin + lane) % width, count = 0;
  for (int first = begin; first < end; first += 32) {
    bool maximum = false;
    float height = 0.0f;
    int const dx = x - radius, dy = y - radius;
    if (first + lane < end) {
      height = plane(dx, dy);
      maximum = height > 0.0f && is_maximum(plane, dx, dy, height);
    }
    unsigned const all = __ballot_sync(0xffffffffu, maximum);
    if (maximum) list[count + __popc(all & ((1u << lane) - 1u))] = {dx, dy, refined_peak(plane, dx, dy, height).height};
    count += __popc(all);
    y += rows_per_step;
    x += columns_per_step;
    if (x >= width) {
      x -= width;
      ++y;
    }
  }
  return count;
}

/// Inserts candidate maxima into the sorted list of the highest peaks. Called by one thread.
__device__ inline void insert_listed(PeakList<float>& found, PlanePeak<float> const* list, int count) {
  for (int k = 0; k < count; ++k)
    if (can_enter(found, list[k].height)) insert_peak(found, list[k]);
}

/// Positive maximum of a plane, encoded as integers: interpolated heights have the order of their bit patterns, shifts
/// have reading order.
struct RankedPeak {
  unsigned height = 0;  ///< bit pattern of the height; 0: no peak
  unsigned order = 0;   ///< position; decreases in reading order

  __device__ int x() const { return static_cast<int>(~order % 256u) - 128; }
  __device__ int y() const { return static_cast<int>(~order / 256u) - 128; }
  __device__ PlanePeak<float> peak() const { return {x(), y(), __uint_as_float(height)}; }
  /// Returns whether this peak is higher, or equally high and first in reading order.
  __device__ bool is_above(RankedPeak const& other) const { return rank() > other.rank(); }

 private:
  __device__ unsigned long long rank() const { return static_cast<unsigned long long>(height) << 32 | order; }
};

/// @pre |x|, |y| < 128
inline __device__ RankedPeak ranked_peak(float height, int x, int y) {
  return {__float_as_uint(height), ~static_cast<unsigned>((y + 128) * 256 + x + 128)};
}

/// The two highest maxima found by a lane of a warp.
struct LanePeaks {
  RankedPeak first, second;
  int count = 0;  ///< number of all maxima found

  /// Returns whether a later maximum of at most that height could be one of the two.
  __device__ bool could_enter(float height) const { return height > __uint_as_float(second.height); }
  __device__ void add(RankedPeak const& peak) {
    bool const above_first = peak.is_above(first), above_second = peak.is_above(second);
    second = above_first ? first : (above_second ? peak : second);
    first = above_first ? peak : first;
    ++count;
  }
  /// Removes the highest maximum of all lanes of the warp and returns it to every lane.
  __device__ RankedPeak take_highest() {
    constexpr unsigned all_lanes = 0xffffffffu;
    RankedPeak best;
    best.height = __reduce_max_sync(all_lanes, first.height);
    best.order = __reduce_max_sync(all_lanes, first.height == best.height ? first.order : 0u);
    if (best.height != 0 && first.order == best.order) {
      first = second;
      second = RankedPeak();
      lowest_taken = best.height;
      ++taken;
    }
    return best;
  }
  /// Upper bound for the height of further maxima that this lane has not stored [bit pattern]; 0 unless both stored
  /// ones were removed and there were more.
  __device__ unsigned missed_below() const { return taken == 2 && count > 2 ? lowest_taken : 0u; }

 private:
  int taken = 0;
  unsigned lowest_taken = 0;
};

/// Four adjacent shifts and their neighbours.
struct PlanePatch {
  float value[3][6];
  __device__ float operator()(int x, int y) const { return value[y + 1][x + 1]; }
};

/// The three highest maxima in a warp's share of the plane, highest first.
struct HighestPeaks {
  RankedPeak peak[PeakList<float>::capacity];
  unsigned missed_below = 0;  ///< upper bound for the height of maxima that were not stored
};

/// Determines the highest maxima of a warp. Called by one full warp.
inline __device__ HighestPeaks highest_of_warp(LanePeaks& own) {
  HighestPeaks highest;
#pragma unroll
  for (RankedPeak& peak : highest.peak) peak = own.take_highest();
  highest.missed_below = __reduce_max_sync(0xffffffffu, own.missed_below());
  return highest;
}

/// Searches rows [begin, end) of the square |x|, |y| <= radius. Called by one full warp.
/// @pre groups of four values, from (-radius, y) on, are aligned
template <int pitch>
__device__ HighestPeaks search_rows(CentredPlane<pitch> const& plane, int radius, int begin, int end) {
  int const lane = static_cast<int>(threadIdx.x % 32u), groups = (2 * radius + 4) / 4;
  int const rows_per_step = 32 / groups, groups_per_step = 32 % groups;
  LanePeaks own;
  for (int y = begin + lane / groups, group = lane % groups; y < end;) {
    int const x = 4 * group - radius;
    PlanePatch patch;
#pragma unroll
    for (int row = 0; row < 3; ++row) {
      float const* const line = plane.centre + (y + row - 1) * pitch + x;
      float4 const middle = *reinterpret_cast<float4 const*>(line);
      patch.value[row][0] = line[-1];
      patch.value[row][1] = middle.x;
      patch.value[row][2] = middle.y;
      patch.value[row][3] = middle.z;
      patch.value[row][4] = middle.w;
      patch.value[row][5] = line[4];
    }
    unsigned maxima = 0;
#pragma unroll
    for (int k = 0; k < 4; ++k) {
      float const height = patch(k, 0);
      bool const found = x + k <= radius && height > 0.0f && is_maximum(patch, k, 0, height);
      maxima |= static_cast<unsigned>(found) << k;
    }
    // Process one maximum of each lane at a time. Of four adjacent shifts at most two are maxima, and their
    // interpolation takes most of the time.
    for (; maxima != 0; maxima &= maxima - 1) {
      int const dx = x + __ffs(static_cast<int>(maxima)) - 1;
      float const height = plane(dx, y);
      if (own.could_enter(static_cast<float>(largest_rise) * height))
        own.add(ranked_peak(refined_peak(plane, dx, y, height).height, dx, y));
      else
        ++own.count;
    }
    y += rows_per_step;
    group += groups_per_step;
    if (group >= groups) {
      group -= groups;
      ++y;
    }
  }
  return highest_of_warp(own);
}

/// Searches the square |x|, |y| <= radius, one block per lane. Called by one full warp.
template <int pitch>
__device__ HighestPeaks search_block(PairedPlane<pitch> const& plane, int radius, SearchBlock const& block) {
  LanePeaks own;
  if (block.x <= radius && block.y <= radius) {
    PlanePeak<float> found[2];
    maxima_of_block(plane, radius, block.x, block.y, found);
    for (PlanePeak<float>& peak : found)
      if (peak.height > 0.0f) peak.height = refined_peak(plane, peak.x, peak.y, peak.height).height;
    RankedPeak const upper = ranked_peak(found[0].height, found[0].x, found[0].y);
    RankedPeak const lower = ranked_peak(found[1].height, found[1].x, found[1].y);
    bool const in_order = upper.height >= lower.height;
    own.first = in_order ? upper : lower;
    own.second = in_order ? lower : upper;
  }
  return highest_of_warp(own);
}

/// Slow search: lists all maxima in reading order. Called by one full warp. @param list  capacity for all maxima
template <class Plane>
__device__ __noinline__ void find_all_peaks(Plane const plane, int radius, PlanePeak<float>* list,
                                            PeakList<float>& found) {
  int const listed = list_maxima(plane, radius, 0, (2 * radius + 1) * (2 * radius + 1), list);
  __syncwarp();
  if (threadIdx.x % 32u == 0) {
    found = {};
    insert_listed(found, list, listed);
    prefer_nearest(plane, radius, found, [&](auto const& visit) {
      for (int k = 0; k < listed; ++k) visit(list[k]);
    });
  }
  __syncwarp();
}

/// Selects the peaks of a window from the highest maxima of all shares; the result equals that of find_peaks(). These
/// are the three highest maxima. If two of them are close to each other or nearly equally high, or a share left out a
/// maximum that could be one of them, all maxima are searched again (find_all_peaks()). Called by one full warp.
/// @param list, found  memory for find_all_peaks()
/// @param own  output: the k-th peak in lane k < 3
/// @return number of peaks
template <class Plane>
__device__ int join_shares(Plane const& plane, int radius, HighestPeaks const* shares, int count,
                           PlanePeak<float>* list, PeakList<float>& found, PlanePeak<float>& own) {
  constexpr int capacity = PeakList<float>::capacity;
  int const lane = static_cast<int>(threadIdx.x % 32u);
  unsigned missed_below = 0;
  LanePeaks candidate;
  for (int k = 0; k < count; ++k) missed_below = max(missed_below, shares[k].missed_below);
  if (lane < capacity * count) candidate.add(shares[lane / capacity].peak[lane % capacity]);
  RankedPeak const first = candidate.take_highest(), second = candidate.take_highest(),
                   third = candidate.take_highest();
  int const peaks = (first.height != 0) + (second.height != 0) + (third.height != 0);
  bool const close = (peaks > 1 && are_close(first.peak(), second.peak())) ||
                     (peaks > 2 && (are_close(first.peak(), third.peak()) || are_close(second.peak(), third.peak())));
  bool const rivals =
      peaks > 1 && second.peak().height >= static_cast<float>(ambiguous_height_ratio) * first.peak().height;
  if (close || missed_below > third.height || rivals) {
    find_all_peaks(plane, radius, list, found);
    own = found.peak[lane < capacity ? lane : 0];
    return found.count;
  }
  own = (lane == 0 ? first : (lane == 1 ? second : third)).peak();
  return peaks;
}

}  // namespace gladstone::cuda::inline correlation
