#include "render/medium/refractive_index_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/files/fields/spline_prefilter.h"

namespace gladstone::inline medium {
namespace {

/// Returns the number of elements along an axis: nodes, one ghost before them, and one (open) or two (periodic) after.
/// A plane has no ghosts along z.
int padded_count(RegularGrid const& grid, int axis) {
  auto const a = static_cast<std::size_t>(axis);
  if (axis == 2 && grid.nodes[2] == 1) return 1;
  return grid.nodes[a] + (grid.periodic[a] ? 3 : 2);
}

}  // namespace

template <class Stored>
std::size_t RefractiveIndexVolume<Stored>::bytes_needed(RegularGrid const& grid) {
  std::size_t count = sizeof(Stored);
  for (int axis = 0; axis < 3; ++axis) count *= static_cast<std::size_t>(padded_count(grid, axis));
  return count;
}

template <class Stored>
std::size_t RefractiveIndexVolume<Stored>::index(int i, int j, int k) const {
  int const pad_z = padded_[2] == 1 ? 0 : 1;
  return static_cast<std::size_t>(i + 1) + static_cast<std::size_t>(row_) * static_cast<std::size_t>(j + 1) +
         static_cast<std::size_t>(plane_) * static_cast<std::size_t>(k + pad_z);
}

template <class Stored>
RefractiveIndexVolume<Stored>::RefractiveIndexVolume(RegularGrid const& grid, Interpolation interpolation, double scale,
                                                     double shift, PlaneFiller const& fill)
    : grid_(grid), interpolation_(interpolation) {
  for (int axis = 0; axis < 3; ++axis) padded_[static_cast<std::size_t>(axis)] = padded_count(grid, axis);
  row_ = padded_[0];
  plane_ = static_cast<std::ptrdiff_t>(padded_[0]) * padded_[1];
  coefficients_.resize(static_cast<std::size_t>(plane_) * static_cast<std::size_t>(padded_[2]));

  // Read slabs of about 16 MB and store them. Values are in double precision until the offset is subtracted.
  int const nx = grid.nodes[0], ny = grid.nodes[1], nz = grid.nodes[2];
  std::size_t const plane_values = static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny);
  int const slab = std::clamp(static_cast<int>((std::size_t{2} << 20) / plane_values), 1, nz);
  std::vector<double> buffer(plane_values * static_cast<std::size_t>(slab));
  double first_value = 0, low = std::numeric_limits<double>::infinity(), high = -low;
  Progress progress("reading the field", static_cast<std::size_t>(nz));
  for (int k0 = 0; k0 < nz; k0 += slab) {
    int const count = std::min(slab, nz - k0);
    fill(k0, count, std::span(buffer).first(plane_values * static_cast<std::size_t>(count)));
    if (k0 == 0) first_value = buffer[0];
    std::mutex extremes;
    parallel_for(static_cast<std::size_t>(count) * static_cast<std::size_t>(ny), [&](std::size_t line) {
      int const j = static_cast<int>(line % static_cast<std::size_t>(ny));
      int const k = static_cast<int>(line / static_cast<std::size_t>(ny));
      double const* from = buffer.data() + line * static_cast<std::size_t>(nx);
      Stored* to = coefficients_.data() + index(0, j, k0 + k);
      double line_low = from[0], line_high = from[0];
      for (int i = 0; i < nx; ++i) {
        to[i] = static_cast<Stored>(scale * (from[i] - first_value));
        line_low = std::min(line_low, from[i]);
        line_high = std::max(line_high, from[i]);
      }
      std::lock_guard const lock(extremes);
      low = std::min(low, line_low);
      high = std::max(high, line_high);
    });
    progress.advance(static_cast<std::size_t>(count));
  }
  buffer = {};
  offset_ = scale * first_value + shift;
  lowest_ = std::min(scale * low, scale * high) + shift;
  highest_ = std::max(scale * low, scale * high) + shift;

  for (int axis = 0; axis < 3; ++axis) {
    if (axis == 2 && nz == 1) continue;
    if (interpolation == Interpolation::cubic_bspline) prefilter_axis(axis);
    if (grid.periodic[static_cast<std::size_t>(axis)]) copy_ghosts(axis);
  }
  measure_steepest();
}

/// Applies the B-spline prefilter to all lines along an axis. Ghost layers of previously filtered axes are filtered
/// like nodes. Lines adjacent in memory are gathered in blocks, so that every cache line is read once.
template <class Stored>
void RefractiveIndexVolume<Stored>::prefilter_axis(int axis) {
  auto const a = static_cast<std::size_t>(axis);
  std::array<std::ptrdiff_t, 3> const stride{1, row_, plane_};
  int const n = grid_.nodes[a];
  int const across = axis == 0 ? 1 : 0;  // axis along which the lines of a block are adjacent
  int const outer = 3 - axis - across;   // axis along which blocks are stacked
  auto const lines_on = [&](int other) {
    return other < axis ? padded_[static_cast<std::size_t>(other)] : grid_.nodes[static_cast<std::size_t>(other)];
  };
  auto const first_on = [&](int other) { return other < axis ? -1 : 0; };
  constexpr int block = 16;
  int const blocks = (lines_on(across) + block - 1) / block;
  auto const total = static_cast<std::size_t>(blocks) * static_cast<std::size_t>(lines_on(outer));
  Progress progress("prefiltering the field", total);
  parallel_for(total, [&](std::size_t task) {
    thread_local std::vector<double> lines, scratch;
    std::size_t const length = static_cast<std::size_t>(n) + 2;
    lines.resize(block * length);
    scratch.resize(static_cast<std::size_t>(n));
    int const first = static_cast<int>(task % static_cast<std::size_t>(blocks)) * block;
    int const count = std::min(block, lines_on(across) - first);
    std::array<int, 3> at{};
    at[static_cast<std::size_t>(across)] = first + first_on(across);
    at[static_cast<std::size_t>(outer)] = static_cast<int>(task / static_cast<std::size_t>(blocks)) + first_on(outer);
    Stored* const base = coefficients_.data() + index(at[0], at[1], at[2]);
    std::ptrdiff_t const along = stride[a], beside = stride[static_cast<std::size_t>(across)];
    for (int i = 0; i < n; ++i) {
      for (int line = 0; line < count; ++line) {
        lines[static_cast<std::size_t>(line) * length + static_cast<std::size_t>(i) + 1] =
            static_cast<double>(base[i * along + line * beside]);
      }
    }
    bool const periodic = grid_.periodic[a];
    for (int line = 0; line < count; ++line) {
      std::span const all(lines.data() + static_cast<std::size_t>(line) * length, length);
      if (periodic) {
        prefilter_periodic(all.subspan(1, static_cast<std::size_t>(n)));
      } else {
        prefilter_open(all, scratch);
      }
    }
    for (int i = periodic ? 0 : -1; i < (periodic ? n : n + 1); ++i) {
      for (int line = 0; line < count; ++line) {
        base[i * along + line * beside] =
            static_cast<Stored>(lines[static_cast<std::size_t>(line) * length + static_cast<std::size_t>(i + 1)]);
      }
    }
    progress.advance();
  });
}

/// Fills the ghost nodes of a periodic axis from its opposite end, so that sampling within a cell needs no wrapping.
template <class Stored>
void RefractiveIndexVolume<Stored>::copy_ghosts(int axis) {
  auto const a = static_cast<std::size_t>(axis);
  std::array<std::ptrdiff_t, 3> const stride{1, row_, plane_};
  int const n = grid_.nodes[a];
  std::array<int, 3> count{};
  for (int other = 0; other < 3; ++other) {
    auto const o = static_cast<std::size_t>(other);
    count[o] = other < axis ? padded_[o] : grid_.nodes[o];
  }
  count[a] = 1;
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        Stored* const line = coefficients_.data() + index(axis > 0 ? i - 1 : 0, axis > 1 ? j - 1 : j, k);
        std::ptrdiff_t const step = stride[a];
        line[-step] = line[(n - 1) * step];
        line[n * step] = line[0];
        line[(n + 1) * step] = line[(n > 1 ? 1 : 0) * step];
      }
    }
  }
}

template <class Stored>
void RefractiveIndexVolume<Stored>::measure_steepest() {
  std::array<std::ptrdiff_t, 3> const stride{1, row_, plane_};
  bool const spline = interpolation_ == Interpolation::cubic_bspline;
  std::mutex merge;
  std::array<double, 3> steepest{};
  auto const low = [&](int axis) { return spline && padded_[static_cast<std::size_t>(axis)] > 1 ? -1 : 0; };
  auto const high = [&](int axis) {
    auto const a = static_cast<std::size_t>(axis);
    if (padded_[a] == 1) return 1;
    return grid_.nodes[a] + (grid_.periodic[a] ? 1 : 0) + (spline ? 1 : 0);  // one past the last element in use
  };
  parallel_for(static_cast<std::size_t>(high(2) - low(2)), [&](std::size_t task) {
    int const k = low(2) + static_cast<int>(task);
    std::array<Stored, 3> local{};
    for (int j = low(1); j < high(1); ++j) {
      Stored const* const line = coefficients_.data() + index(0, j, k);
      for (int axis = 0; axis < 3; ++axis) {
        if ((axis == 1 && j + 1 == high(1)) || (axis == 2 && k + 1 == high(2))) continue;
        auto const a = static_cast<std::size_t>(axis);
        Stored largest = local[a];
        int const end = axis == 0 ? high(0) - 1 : high(0);
        for (int i = low(0); i < end; ++i) largest = std::max(largest, std::abs(line[i + stride[a]] - line[i]));
        local[a] = largest;
      }
    }
    std::lock_guard const lock(merge);
    for (std::size_t a = 0; a < 3; ++a) steepest[a] = std::max(steepest[a], static_cast<double>(local[a]));
  });
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double const slope = steepest[static_cast<std::size_t>(axis)] / grid_.spacing[axis];
    sum += slope * slope;
  }
  steepest_ = std::sqrt(sum);
}

template class RefractiveIndexVolume<float>;
template class RefractiveIndexVolume<double>;

}  // namespace gladstone::inline medium
