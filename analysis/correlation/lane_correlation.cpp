#include "analysis/correlation/lane_correlation.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "analysis/correlation/lane_peaks.h"
#include "analysis/correlation/plane_sums.h"
#include "render/base/contracts.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"

namespace gladstone::inline correlation {
namespace {

constexpr std::size_t windows_per_chunk = 8 * lane_count;

/// Workspace in which one thread correlates a chunk of windows; later chunks reuse it.
struct Workspace {
  LaneCorrelation correlation;
  LanePlane plane;
  VisitPlanes visit;
};

/// Pool of idle workspaces.
class WorkspacePool {
 public:
  explicit WorkspacePool(std::function<std::unique_ptr<Workspace>()> make) : make_(std::move(make)) {}

  std::unique_ptr<Workspace> take() {
    {
      std::lock_guard<std::mutex> const lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<Workspace> place = std::move(free_.back());
        free_.pop_back();
        return place;
      }
    }
    return make_();
  }
  void give_back(std::unique_ptr<Workspace> place) {
    std::lock_guard<std::mutex> const lock(mutex_);
    free_.push_back(std::move(place));
  }

 private:
  std::function<std::unique_ptr<Workspace>()> make_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Workspace>> free_;
};

}  // namespace

LaneCorrelation::LaneCorrelation(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y,
                                 KnownTiles const& tiles, WindowMeans const& means, LaneFourier const& fourier,
                                 bool with_margin)
    : x_(x), y_(y), fourier_(fourier), windows_(job, x, y, tiles, means, with_margin) {
  int const size = fourier.size(), side = windows_.side();
  pitch_ = LaneFourier::pitch(size);
  half_pitch_ = (size / 2 + 1) | 1;
  std::size_t const lines = static_cast<std::size_t>(side);
  spectrum_.resize(lines * pitch_);
  half_.resize(static_cast<std::size_t>(2 * job.search_radius_px + 4) * half_pitch_);
  line_.resize(static_cast<std::size_t>(std::max(size, side + lane_count)));
  column_.resize(static_cast<std::size_t>(size));
  mirror_.resize(static_cast<std::size_t>(size));
  scratch_.resize(static_cast<std::size_t>(fourier.scratch()));
}

int LaneCorrelation::transform_size(InterrogationJob const& job, bool with_margin) {
  int const window = job.grid.window_px, radius = job.search_radius_px;
  return with_margin ? lane_fourier_size(window_side_px(job.weighting, window) + 2 * radius + 2)
                     : plane_transform_size(job.weighting, window, radius);
}

int plane_transform_size(WindowWeighting weighting, int window, int radius) {
  if (weighting == WindowWeighting::gaussian) return lane_fourier_size(window_side_px(weighting, window));
  // The fit of a peak at the limit of the search range reads one pixel beyond this limit, where one line of the
  // window's pixels wraps around. In large windows this line is too small a part of the window to justify a longer
  // transform.
  return lane_fourier_size(window + radius + (window < 32 ? 1 : 0));
}

void LaneCorrelation::load(WindowTerm term) {
  int const side = windows_.side();
  for (int j = 0; j < side; ++j) {
    windows_.row(j, term, line_.data());
    fourier_.forward(line_.data(), 1, side, spectrum_.data() + static_cast<std::size_t>(j) * pitch_, scratch_.data());
  }
}

void LaneCorrelation::correlate(FloatLanes scale, SpectrumFilter const& filter, LanePlane& plane) {
  filter_columns(scale, filter, plane.reach());
  make_rows(plane);
}

/// Transforms the columns, multiplies and filters the spectra, and transforms back. Afterwards half_ contains the
/// spectrum along x for each vertical shift; half of this spectrum suffices since the planes are real.
void LaneCorrelation::filter_columns(FloatLanes scale, SpectrumFilter const& filter, int reach) {
  int const size = fourier_.size(), side = windows_.side();
  FloatLanes const half = 0.5f * scale, quarter = 0.25f * scale;
  for (int kx = 0; kx <= size / 2; ++kx) {
    int const mx = (size - kx) % size;
    fourier_.forward(spectrum_.data() + kx, pitch_, side, column_.data(), scratch_.data());
    ComplexLanes const* z = column_.data();
    ComplexLanes const* m = z;
    if (mx != kx) {
      fourier_.forward(spectrum_.data() + mx, pitch_, side, mirror_.data(), scratch_.data());
      m = mirror_.data();
    }
    // Compute the cross spectrum by the formula of cross_spectrum().
    for (int ky = 0; ky < size; ++ky) {
      ComplexLanes const& a = z[ky];
      ComplexLanes const& b = m[ky == 0 ? 0 : size - ky];
      line_[static_cast<std::size_t>(ky)] = {half * (a.re * b.im + a.im * b.re),
                                             quarter * ((b.re * b.re + b.im * b.im) - (a.re * a.re + a.im * a.im))};
    }
    if (filter) filter(line_.data(), kx, size);
    fourier_.inverse(line_.data(), column_.data(), scratch_.data());
    for (int dy = -reach; dy <= reach; ++dy)
      half_[static_cast<std::size_t>(dy + reach) * half_pitch_ + kx] =
          column_[static_cast<std::size_t>(dy < 0 ? dy + size : dy)];
  }
}

/// Computes the rows of the real planes, two rows by each complex transform.
void LaneCorrelation::make_rows(LanePlane& plane) {
  int const size = fourier_.size(), reach = plane.reach();
  for (int dy = -reach; dy <= reach; dy += 2) {
    bool const both = dy < reach;
    ComplexLanes const* a = half_.data() + static_cast<std::size_t>(dy + reach) * half_pitch_;
    ComplexLanes const* b = both ? a + half_pitch_ : a;
    for (int k = 0; k <= size / 2; ++k) {
      line_[static_cast<std::size_t>(k)] = {a[k].re - b[k].im, a[k].im + b[k].re};
      if (k > 0 && k < size / 2) line_[static_cast<std::size_t>(size - k)] = {a[k].re + b[k].im, b[k].re - a[k].im};
    }
    fourier_.inverse(line_.data(), column_.data(), scratch_.data());
    for (int dx = -reach; dx <= reach; ++dx) {
      ComplexLanes const& value = column_[static_cast<std::size_t>(dx < 0 ? dx + size : dx)];
      plane(dx, dy) = value.re;
      if (both) plane(dx, dy + 1) = value.im;
    }
  }
}

void visit_planes(InterrogationJob const& job, PlaneMethod const& method,
                  std::function<VisitPlanes()> const& make_visitor) {
  int const radius = job.search_radius_px, window = job.grid.window_px;
  GLADSTONE_EXPECTS(radius > 0 && 2 * radius <= window && window % 2 == 0);
  AxisWeights const x(job.grid, GridAxis::x, job.pair.columns, job.weighting);
  AxisWeights const y(job.grid, GridAxis::y, job.pair.rows, job.weighting);
  KnownTiles const tiles(job.pair);
  WindowMeans const means(job, x.view(), y.view());
  LaneFourier const fourier(LaneCorrelation::transform_size(job, method.with_margin));
  Progress progress(job.label, job.grid.size());
  WorkspacePool workspaces([&] {
    return std::unique_ptr<Workspace>(new Workspace{
        {job, x.view(), y.view(), tiles, means, fourier, method.with_margin}, LanePlane(radius), make_visitor()});
  });
  parallel_chunks(job.grid.size(), windows_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<Workspace> here = workspaces.take();
    for (std::size_t first = begin; first < end; first += lane_count) {
      int const count = static_cast<int>(std::min<std::size_t>(lane_count, end - first));
      here->correlation.windows().place(first, count);
      method.make(here->correlation, here->plane);
      here->visit(first, count, here->correlation, here->plane);
    }
    workspaces.give_back(std::move(here));
    progress.advance(end - begin);
  });
}

std::vector<WindowCorrelation> correlate_in_lanes(InterrogationJob const& job, PlaneMethod const& method) {
  std::vector<WindowCorrelation> results(job.grid.size());
  visit_planes(job, method, [&] {
    auto const peaks = std::make_shared<LanePeaks>(job, method.decreases_with_shift);
    return [peaks, &results, &job](std::size_t first, int count, LaneCorrelation& work, LanePlane& plane) {
      WindowCorrelation::Outcome outcome[lane_count];
      for (int lane = 0; lane < count; ++lane) outcome[lane] = work.windows().outcome(lane);
      if (job.ensemble != nullptr) job.ensemble->add(first, count, plane, outcome);
      peaks->pick(work, plane, outcome, count, results.data() + first);
    };
  });
  return results;
}

}  // namespace gladstone::inline correlation
