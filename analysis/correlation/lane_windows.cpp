#include "analysis/correlation/lane_windows.h"

#include <algorithm>

namespace gladstone::inline correlation {
namespace {

int whole_lanes(int count) { return (count + lane_count - 1) / lane_count * lane_count; }

/// Weighted sums over the pixels of a window, accumulated row by row.
struct LaneSums {
  FloatLanes weight{}, reference{}, flow{};

  float mean_reference(float all) const { return sum_of_lanes(reference) / all; }
  float mean_flow(float all) const { return sum_of_lanes(flow) / all; }
};

}  // namespace

LaneWindows::LaneWindows(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y,
                         KnownTiles const& tiles, WindowMeans const& means, bool with_margin)
    : job_(job), x_(x), y_(y), tiles_(tiles), means_(means) {
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
  // All windows inside the image have equal weights, which are gathered only once.
  if (!(whole && gathered_)) gather_weights();
  gathered_ = whole;
  reference_ = flow_ = core_reference_ = core_flow_ = FloatLanes{};
}

void LaneWindows::gather_weights() {
  for (int i = 0; i < side_; ++i)
    for (int lane = 0; lane < lane_count; ++lane) {
      weight_x_[static_cast<std::size_t>(margin_ + i)][lane] = x_.weight(column_[lane])[offset_ + i];
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
  Vec2<float> const means = means_.of(column_[lane], row_[lane]);
  source_[lane] = {pair.reference.data() + at, pair.flow.data() + at, pair.columns, means.x, means.y};
}

/// Copies a window at the border or with unknown pixels, subtracts its mean, and sets unknown pixels to 0.
void LaneWindows::copy_lane(int lane, int first_x, int first_y, float const* weight_x, float const* weight_y) {
  ImagePair const& pair = job_.pair;
  int const side = side_ + 2 * margin_, left = first_x - margin_, top = first_y - margin_;
  std::size_t const plane = static_cast<std::size_t>(padded_) * side;
  patch_[lane].assign(3 * plane + padded_, 0.0f);
  float* const reference = patch_[lane].data();
  float* const flow = reference + plane;
  float* const known = flow + plane;
  float* const weight = known + plane;  // weights of the columns, including the margin
  std::copy_n(weight_x, side_, weight + margin_);
  int const begin_x = std::max(0, -left), end_x = std::min(side, pair.columns - left);
  int const begin_y = std::max(0, -top), end_y = std::min(side, pair.rows - top);
  LaneSums sums;
  for (int j = begin_y; j < end_y && begin_x < end_x; ++j) {
    std::size_t const at = static_cast<std::size_t>(top + j) * pair.columns + (left + begin_x);
    std::size_t const to = static_cast<std::size_t>(j) * padded_;
    std::size_t const count = static_cast<std::size_t>(end_x - begin_x);
    std::copy_n(pair.reference.data() + at, count, reference + to + begin_x);
    std::copy_n(pair.flow.data() + at, count, flow + to + begin_x);
    if (pair.available.empty())
      std::fill_n(known + to + begin_x, count, 1.0f);
    else
      std::copy_n(pair.available.data() + at, count, known + to + begin_x);
    if (j < margin_ || j >= margin_ + side_) continue;
    float const down = weight_y[j - margin_];
    for (int i = 0; i < padded_; i += lane_count) {
      FloatLanes const w = down * load_lanes(weight + i) * load_lanes(known + to + i);
      sums.weight += w;
      sums.reference += w * load_lanes(reference + to + i);
      sums.flow += w * load_lanes(flow + to + i);
    }
  }
  float const all = sum_of_lanes(sums.weight);
  if (all < min_valid_weight_fraction * x_.sum(column_[lane]) * y_.sum(row_[lane]))
    outcome_[lane] = WindowCorrelation::Outcome::masked;
  float const mean_reference = sums.mean_reference(all > 0.0f ? all : 1.0f);
  float const mean_flow = sums.mean_flow(all > 0.0f ? all : 1.0f);
  for (std::size_t i = 0; i < plane; i += lane_count) {
    FloatLanes const here = load_lanes(known + i);
    store_lanes(reference + i, here * (load_lanes(reference + i) - mean_reference));
    store_lanes(flow + i, here * (load_lanes(flow + i) - mean_flow));
  }
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
  if constexpr (term == WindowTerm::search_energy) return {w * w, b * b};
  if constexpr (term == WindowTerm::search_back) return {a, w * w * b};
  return {a * a, w * w};
}

}  // namespace

/// Computes a row of a term. @return sums of the squares of the real and of the imaginary parts of the row
template <WindowTerm term>
ComplexLanes LaneWindows::row_of_term(int j, ComplexLanes* out) const {
  int const line = j - margin_;
  bool const in_window = line >= 0 && line < side_;
  ComplexLanes squares{};
  FloatLanes const wy = in_window ? weight_y_[static_cast<std::size_t>(line)] : FloatLanes{};
  for (int i = 0; i < padded_; i += lane_count) {
    FloatLanes a[lane_count], b[lane_count];
    auto const at = [&](int lane) { return static_cast<std::ptrdiff_t>(line) * source_[lane].stride + (i - margin_); };
    read_columns([&](int lane) { return source_[lane].reference + at(lane); }, a);
    read_columns([&](int lane) { return source_[lane].flow + at(lane); }, b);
    for (int k = 0; k < lane_count; ++k) {
      out[i + k] =
          term_of<term>(wy * weight_x_[static_cast<std::size_t>(i + k)], a[k] - mean_reference_, b[k] - mean_flow_);
      squares.re += out[i + k].re * out[i + k].re;
      squares.im += out[i + k].im * out[i + k].im;
    }
  }
  return squares;
}

/// Accumulates the energies of w A and w B from a row, separately for the nominal window. Pixels outside the image have
/// zero weight.
void LaneWindows::gather_energies(int j, ComplexLanes const* row, ComplexLanes const& whole) {
  reference_ += whole.re;
  flow_ += whole.im;
  int const core_first = margin_ + job_.grid.window_px / 2 - offset_, core_end = core_first + job_.grid.window_px;
  if (j < core_first || j >= core_end) return;
  bool const is_whole = side_ == job_.grid.window_px;
  ComplexLanes core = is_whole ? whole : ComplexLanes{};
  for (int i = is_whole ? core_end : core_first; i < core_end; ++i) {
    core.re += row[i].re * row[i].re;
    core.im += row[i].im * row[i].im;
  }
  core_reference_ += core.re;
  core_flow_ += core.im;
}

void LaneWindows::row(int j, WindowTerm term, ComplexLanes* out) {
  switch (term) {
    case WindowTerm::frames:
      return gather_energies(j, out, row_of_term<WindowTerm::frames>(j, out));
    case WindowTerm::reference_energy:
      row_of_term<WindowTerm::reference_energy>(j, out);
      return;
    case WindowTerm::flow_energy:
      row_of_term<WindowTerm::flow_energy>(j, out);
      return;
    case WindowTerm::search:
      gather_energies(j, out, row_of_term<WindowTerm::frames>(j, out));
      row_of_term<WindowTerm::search>(j, out);
      return;
    case WindowTerm::search_energy:
      row_of_term<WindowTerm::search_energy>(j, out);
      return;
    case WindowTerm::search_back:
      row_of_term<WindowTerm::search_back>(j, out);
      return;
    case WindowTerm::search_back_energy:
      row_of_term<WindowTerm::search_back_energy>(j, out);
      return;
  }
}

FloatLanes LaneWindows::scale(int size) {
  FloatLanes result{};
  for (int lane = 0; lane < lane_count; ++lane) {
    if (outcome_[lane] != WindowCorrelation::Outcome::measured) continue;
    WindowEnergy const energy{reference_[lane], flow_[lane], core_reference_[lane], core_flow_[lane]};
    result[lane] = static_cast<float>(plane_scale(energy, job_.pair.contrast, job_.grid.window_px, size));
    if (result[lane] == 0.0f) outcome_[lane] = WindowCorrelation::Outcome::no_signal;
  }
  return result;
}

}  // namespace gladstone::inline correlation
