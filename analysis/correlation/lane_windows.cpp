#include "analysis/correlation/lane_windows.h"

#include <algorithm>

namespace gladstone {
namespace {

int whole_lanes(int count) { return (count + lane_count - 1) / lane_count * lane_count; }

struct LaneSums {
  float weight = 0.0f, reference = 0.0f, flow = 0.0f;
};

float sum_of_lanes(FloatLanes v) { return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7])); }

}  // namespace

LaneWindows::LaneWindows(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y,
                         KnownTiles const& tiles, bool with_margin)
    : job_(job), x_(x), y_(y), tiles_(tiles) {
  bool const uniform = job.weighting == WindowWeighting::uniform;
  offset_ = uniform ? job.grid.window_px / 2 : 0;
  side_ = uniform ? job.grid.window_px : 2 * job.grid.window_px;
  margin_ = with_margin ? job.search_radius_px + 1 : 0;
  padded_ = whole_lanes(side_ + 2 * margin_);
  weight_x_.resize(static_cast<std::size_t>(padded_));
  weight_y_.resize(static_cast<std::size_t>(padded_));
}

void LaneWindows::place(std::size_t begin, int count) {
  bool whole = true;
  for (int lane = 0; lane < lane_count; ++lane) {
    place_lane(lane, begin + static_cast<std::size_t>(std::min(lane, count - 1)));
    float const* const wx = x_.weight(column_[lane]) + offset_;
    float const* const wy = y_.weight(row_[lane]) + offset_;
    whole = whole && wx[0] > 0.0f && wx[side_ - 1] > 0.0f && wy[0] > 0.0f && wy[side_ - 1] > 0.0f;
    mean_reference_[lane] = source_[lane].mean_reference;
    mean_flow_[lane] = source_[lane].mean_flow;
  }
  // windows that no border cuts have equal weights
  if (!(whole && gathered_)) gather_weights();
  gathered_ = whole;
  reference_ = flow_ = core_reference_ = core_flow_ = FloatLanes{};
}

void LaneWindows::gather_weights() {
  for (int i = 0; i < side_; ++i)
    for (int lane = 0; lane < lane_count; ++lane) {
      weight_x_[static_cast<std::size_t>(i)][lane] = x_.weight(column_[lane])[offset_ + i];
      weight_y_[static_cast<std::size_t>(i)][lane] = y_.weight(row_[lane])[offset_ + i];
    }
}

void LaneWindows::place_lane(int lane, std::size_t window) {
  ImagePair const& pair = job_.pair;
  column_[lane] = static_cast<int>(window % static_cast<std::size_t>(job_.grid.columns));
  row_[lane] = static_cast<int>(window / static_cast<std::size_t>(job_.grid.columns));
  outcome_[lane] = WindowCorrelation::Outcome::measured;
  int const first_x = x_.first(column_[lane]) + offset_, first_y = y_.first(row_[lane]) + offset_;
  float const* const wx = x_.weight(column_[lane]) + offset_;
  float const* const wy = y_.weight(row_[lane]) + offset_;
  bool const inside = first_x >= margin_ && first_y >= margin_ && first_x - margin_ + padded_ <= pair.columns &&
                      first_y + side_ + margin_ <= pair.rows;
  if (!inside ||
      !tiles_.all_known(first_x - margin_, first_y - margin_, first_x - margin_ + padded_, first_y + side_ + margin_))
    return copy_lane(lane, first_x, first_y, wx, wy);
  std::size_t const at = static_cast<std::size_t>(first_y) * pair.columns + first_x;
  Source source{pair.reference.data() + at, pair.flow.data() + at, pair.columns, 0.0f, 0.0f};
  LaneSums sums;
  int const whole = side_ / lane_count * lane_count;
  for (int j = 0; j < side_; ++j) {
    float const* a = source.reference + static_cast<std::size_t>(j) * source.stride;
    float const* b = source.flow + static_cast<std::size_t>(j) * source.stride;
    FloatLanes weight{}, reference{}, flow{};
    for (int i = 0; i < whole; i += lane_count) {
      FloatLanes const w = load_lanes(wx + i);
      weight += w;
      reference += w * load_lanes(a + i);
      flow += w * load_lanes(b + i);
    }
    LaneSums line{sum_of_lanes(weight), sum_of_lanes(reference), sum_of_lanes(flow)};
    for (int i = whole; i < side_; ++i) {
      line.weight += wx[i];
      line.reference += wx[i] * a[i];
      line.flow += wx[i] * b[i];
    }
    sums.weight += wy[j] * line.weight;
    sums.reference += wy[j] * line.reference;
    sums.flow += wy[j] * line.flow;
  }
  source.mean_reference = sums.reference / sums.weight;
  source.mean_flow = sums.flow / sums.weight;
  source_[lane] = source;
}

/// A window at the border or with unknown pixels is copied, its mean taken off and 0 where nothing is known.
void LaneWindows::copy_lane(int lane, int first_x, int first_y, float const* weight_x, float const* weight_y) {
  ImagePair const& pair = job_.pair;
  int const side = side_ + 2 * margin_;
  std::size_t const plane = static_cast<std::size_t>(padded_) * side;
  patch_[lane].assign(2 * plane, 0.0f);
  float* const reference = patch_[lane].data();
  float* const flow = reference + plane;
  auto const for_each_known = [&](auto const& visit) {
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        int const x = first_x - margin_ + i, y = first_y - margin_ + j;
        if (x < 0 || x >= pair.columns || y < 0 || y >= pair.rows) continue;
        std::size_t const at = static_cast<std::size_t>(y) * pair.columns + x;
        if (!pair.available.empty() && pair.available[at] == 0.0f) continue;
        int const wi = i - margin_, wj = j - margin_;
        bool const counts = wi >= 0 && wi < side_ && wj >= 0 && wj < side_;
        visit(static_cast<std::size_t>(j) * padded_ + i, at, counts ? weight_x[wi] * weight_y[wj] : 0.0f);
      }
  };
  LaneSums sums;
  for_each_known([&](std::size_t, std::size_t at, float weight) {
    sums.weight += weight;
    sums.reference += weight * pair.reference[at];
    sums.flow += weight * pair.flow[at];
  });
  if (sums.weight < smallest_known_part * x_.sum(column_[lane]) * y_.sum(row_[lane]))
    outcome_[lane] = WindowCorrelation::Outcome::masked;
  float const known = sums.weight > 0.0f ? sums.weight : 1.0f;
  float const mean_reference = sums.reference / known, mean_flow = sums.flow / known;
  for_each_known([&](std::size_t to, std::size_t at, float) {
    reference[to] = pair.reference[at] - mean_reference;
    flow[to] = pair.flow[at] - mean_flow;
  });
  std::size_t const first = static_cast<std::size_t>(margin_) * padded_ + margin_;
  source_[lane] = {reference + first, flow + first, padded_, 0.0f, 0.0f};
}

namespace {

template <WindowTerm term>
ComplexLanes term_of(FloatLanes w, FloatLanes a, FloatLanes b) {
  if constexpr (term == WindowTerm::frames) return {w * a, w * b};
  if constexpr (term == WindowTerm::reference_energy) return {w * a * a, w};
  if constexpr (term == WindowTerm::flow_energy) return {w, w * b * b};
  if constexpr (term == WindowTerm::search) return {w * w * a, b};
  return {w * w, b * b};
}

}  // namespace

template <WindowTerm term>
void LaneWindows::row_of_term(int j, ComplexLanes* out) {
  constexpr bool with_energies = term == WindowTerm::frames || term == WindowTerm::search;
  int const count = side(), line = j - margin_;
  bool const in_window = line >= 0 && line < side_;
  int const core_first = job_.grid.window_px / 2 - offset_, core_end = core_first + job_.grid.window_px;
  FloatLanes const wy = in_window ? weight_y_[static_cast<std::size_t>(line)] : FloatLanes{};
  FloatLanes reference{}, flow{}, core_reference{}, core_flow{};
  for (int i = 0; i < count; i += lane_count) {
    FloatLanes a[lane_count], b[lane_count];
    for (int lane = 0; lane < lane_count; ++lane) {
      std::ptrdiff_t const at = static_cast<std::ptrdiff_t>(line) * source_[lane].stride + (i - margin_);
      a[lane] = load_lanes(source_[lane].reference + at);
      b[lane] = load_lanes(source_[lane].flow + at);
    }
    transpose_lanes(a);
    transpose_lanes(b);
    for (int k = 0; k < lane_count && i + k < count; ++k) {
      int const at = i + k - margin_;
      FloatLanes const w = at >= 0 && at < side_ ? wy * weight_x_[static_cast<std::size_t>(at)] : FloatLanes{};
      FloatLanes const in_reference = a[k] - mean_reference_, in_flow = b[k] - mean_flow_;
      out[i + k] = term_of<term>(w, in_reference, in_flow);
      if constexpr (with_energies) {
        FloatLanes const wa = w * in_reference, wb = w * in_flow, aa = wa * wa, bb = wb * wb;
        reference += aa;
        flow += bb;
        if (at >= core_first && at < core_end) {
          core_reference += aa;
          core_flow += bb;
        }
      }
    }
  }
  if constexpr (with_energies) {
    reference_ += reference;
    flow_ += flow;
    if (line >= core_first && line < core_end) {
      core_reference_ += core_reference;
      core_flow_ += core_flow;
    }
  }
}

void LaneWindows::row(int j, WindowTerm term, ComplexLanes* out) {
  switch (term) {
    case WindowTerm::frames:
      return row_of_term<WindowTerm::frames>(j, out);
    case WindowTerm::reference_energy:
      return row_of_term<WindowTerm::reference_energy>(j, out);
    case WindowTerm::flow_energy:
      return row_of_term<WindowTerm::flow_energy>(j, out);
    case WindowTerm::search:
      return row_of_term<WindowTerm::search>(j, out);
    case WindowTerm::search_energy:
      return row_of_term<WindowTerm::search_energy>(j, out);
  }
}

FloatLanes LaneWindows::scale(int size) {
  FloatLanes result{};
  for (int lane = 0; lane < lane_count; ++lane) {
    if (outcome_[lane] != WindowCorrelation::Outcome::measured) continue;
    WindowEnergy<float> const energy{reference_[lane], flow_[lane], core_reference_[lane], core_flow_[lane]};
    result[lane] = static_cast<float>(plane_scale(energy, job_.pair.contrast, job_.grid.window_px, size));
    if (result[lane] == 0.0f) outcome_[lane] = WindowCorrelation::Outcome::no_signal;
  }
  return result;
}

}  // namespace gladstone
