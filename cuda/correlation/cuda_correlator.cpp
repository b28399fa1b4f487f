#include "cuda/correlation/cuda_correlator.h"

#include <algorithm>
#include <mutex>
#include <utility>
#include <vector>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/lane_correlation.h"
#include "analysis/correlation/methods/rpc.h"
#include "analysis/correlation/standard_correlator.h"
#include "analysis/correlation/steep_refinement.h"
#include "analysis/correlation/subpixel_fit.h"
#include "analysis/uncertainty/pass_amplification.h"
#include "analysis/uncertainty/uncertainty.h"
#include "cuda/correlation/correlation_kernels.h"
#include "cuda/correlation/correlation_statistics.h"
#include "cuda/device/device_array.h"
#include "cuda/device/device_frames.h"
#include "cuda/device/staging_pool.h"
#include "render/base/interrupt.h"

namespace gladstone::cuda::inline correlation {
namespace {

constexpr char const* purpose = "correlation";

template <class T>
DeviceArray<T> on_device(std::vector<T> const& values) {
  return DeviceArray<T>(values.data(), values.size(), purpose);
}

/// Weights along one axis in device memory.
class DeviceAxisWeights {
 public:
  explicit DeviceAxisWeights(AxisWeights const& host)
      : weights_(on_device(host.weights())),
        autocorrelations_(on_device(host.autocorrelations())),
        sums_(on_device(host.sums())),
        view_(host.view()) {
    view_.weights = weights_.data();
    view_.autocorrelations = autocorrelations_.data();
    view_.sums = sums_.data();
  }
  AxisWeightsView const& view() const { return view_; }

 private:
  DeviceArray<float> weights_;
  DeviceArray<double> autocorrelations_;
  DeviceArray<double> sums_;
  AxisWeightsView view_;
};

/// Scratch memory for concurrent windows that do not fit into shared memory.
struct WindowScratch {
  DeviceArray<float> memory;
  int slots = 0;

  /// Allocates memory for `windows` concurrent windows, at most 264, or for fewer if device memory is short.
  /// @param values  floats per window
  void make(std::size_t values, std::size_t windows) {
    if (values == 0) return;
    for (auto wanted = std::min<std::size_t>(windows, 264);; wanted = (wanted + 1) / 2) try {
        memory = DeviceArray<float>(values * wanted, "correlation of large windows");
        slots = static_cast<int>(wanted);
        return;
      } catch (OutOfDeviceMemory const&) {
        if (wanted == 1) throw;
      }
  }
};

/// Vectors of a pair, copied from the device.
struct DownloadedVectors {
  InterrogationGrid grid;
  std::vector<MeasuredVector> measured;
  std::vector<Vec2d> sigma_px;

  DisplacementField field() && {
    DisplacementField field = displacement_field(grid, measured);
    field.sigma_px = std::move(sigma_px);
    return field;
  }
};

}  // namespace

/// Device memory and tables for image pairs of one size.
class CorrelationPlan {
 public:
  CorrelationPlan(CorrelationSettings const& settings, int columns, int rows)
      : schedule_(settings),
        phase_only_(correlation_method(settings.method).by_phase),
        nine_points_(subpixel_method(settings.subpixel).nine_points),
        with_sigma_(settings.estimates_uncertainty() && uncertainty_on_gpu(settings.uncertainty)),
        amplification_(with_sigma_ ? amplification_of_passes(settings) : 1.0),
        columns_(columns),
        rows_(rows) {
    std::size_t const pixels = static_cast<std::size_t>(columns) * rows;
    original_ = Pair(pixels);
    if (deforms()) {
      deformed_ = Pair(pixels);
      constexpr int margin = BsplineView<float>::margin_before + BsplineView<float>::margin_after;
      std::size_t const coefficients = static_cast<std::size_t>(columns + margin) * (rows + margin);
      for (DeviceArray<float>& spline : spline_) spline = DeviceArray<float>(coefficients, purpose);
      std::vector<double> const taps = bspline_taps(schedule_.spline_degree());
      taps_ = on_device(std::vector<float>(taps.begin(), taps.end()));
    }
    std::size_t most_vectors = 0, most_nodes = 0;
    for (int pass = 0; pass < schedule_.passes(); ++pass) {
      passes_.push_back(make_pass(pass));
      Pass const& made = passes_.back();
      most_vectors = std::max(most_vectors, made.grid.size());
      if (with_sigma_ || !schedule_.is_last(pass))
        most_nodes = std::max(most_nodes, static_cast<std::size_t>(made.predictor.columns) * made.predictor.rows);
    }
    windows_ = DeviceArray<WindowCorrelation>(most_vectors, purpose);
    peaks_ = DeviceArray<WindowPeaks>(most_vectors, purpose);
    vectors_ = DeviceArray<GridVector>(most_vectors, purpose);
    for (DeviceArray<char>& flags : ambiguous_) flags = DeviceArray<char>(most_vectors, purpose);
    measured_ = DeviceArray<MeasuredVector>(passes_.back().grid.size(), purpose);
    measured_.zero();  // initialise the padding bytes, which are copied to the host as well
    list_ = DeviceArray<Replacement>(most_vectors, purpose);
    if (with_sigma_)
      for (DeviceArray<Vec2d>* of_vectors : {&variances_, &sigma_})
        *of_vectors = DeviceArray<Vec2d>(passes_.back().grid.size(), purpose);
    if (deforms()) {
      nodes_ = DeviceArray<Vec2d>(most_vectors, purpose);
      known_ = DeviceArray<char>(most_vectors, purpose);
      extended_ = DeviceArray<Vec2d>(most_nodes, purpose);
    }
  }

  bool suits(int columns, int rows) const { return columns == columns_ && rows == rows_; }

  /// Copies both images of a pair to the device.
  /// @param staged  pixels of frame A, then those of frame B, in page-locked memory, which must remain unchanged until
  /// the vectors have been downloaded
  void upload(double const* staged) {
    std::size_t const pixels = static_cast<std::size_t>(columns_) * rows_;
    for (DeviceArray<double>& image : uploaded_) {
      if (image.size() == 0) image = DeviceArray<double>(pixels, purpose);
      copy_pinned_to_device(image.data(), staged, pixels * sizeof(double));
      staged += pixels;
    }
  }
  DeviceImage uploaded(int which) const { return {uploaded_[which].data(), columns_, rows_}; }

  DownloadedVectors correlate(DeviceImage const& reference, DeviceImage const& flow) {
    enqueue(reference, flow);
    return download();
  }

  /// Queues all work up to the vectors, which remain on the device. With several passes, it waits for the last one to
  /// find out whether gradients are steep.
  void enqueue(DeviceImage const& reference, DeviceImage const& flow) {
    if (!has_scratch_) make_scratch();  // last, because it uses the remaining memory
    DevicePair const original = original_.view(columns_, rows_), deformed = deformed_.view(columns_, rows_);
    prepare_pair(reference, flow, keys_.data(), contrast_.data(), original);
    BsplineView<float> spline[2] = {};
    if (deforms())  // the memory of the deformed pair serves as scratch
      filter_pair(original, taps_.data(), static_cast<int>(taps_.size()), deformed.pixels,
                  {spline_[0].data(), spline_[1].data()}, spline);
    for (int pass = 0;; ++pass) {
      throw_if_interrupted();
      Pass const& now = passes_[pass];
      if (pass > 0)
        deform_pair(spline[0], spline[1], schedule_.spline_degree(), original, predictor(pass - 1), deformed);
      correlate_windows(now, pass > 0 ? deformed : original);
      take_vectors(windows_.data(), vectors_.data(), now.grid, deformed_by(pass), schedule_.limit_px(), before(pass),
                   ambiguous_[pass % 2].data());
      validate(vectors_.data(), now.grid, schedule_.rule(pass), list_.data(), list_size_.data());
      if (schedule_.is_last(pass)) break;
      make_predictor_of(pass);
    }
    if (schedule_.steep_passes() > 0 && has_steep_gradient()) refine(spline, original, deformed);
    if (with_sigma_) {
      int const last = schedule_.passes() - 1;
      make_predictor_of(last);
      deform_pair(spline[0], spline[1], schedule_.spline_degree(), original, predictor(last), deformed);
      estimate_sigma_of(passes_[last], deformed);
    }
    finish(windows_.data(), vectors_.data(), passes_.back().grid, measured_.data());
  }

 private:
  struct Pair {
    Pair() = default;
    explicit Pair(std::size_t size) : pixels(size, purpose) {}
    DevicePair view(int columns, int rows) { return {pixels.data(), columns, rows}; }
    DeviceArray<GreyPair> pixels;
  };

  struct Pass {
    InterrogationGrid grid;
    int search_radius_px;
    PredictorView predictor;  ///< computed from the vectors of this pass
    DeviceAxisWeights x, y;
    int side, size;  ///< side of a window [px], length of the transforms
    LinePlan lines;
    DeviceArray<Complex> roots;
    DeviceArray<float> particles;  ///< weights of the phases for rpc
  };

  Pass make_pass(int pass) const {
    InterrogationGrid const grid = schedule_.grid(pass, columns_, rows_);
    int const ghosts = ghost_nodes(grid, columns_, rows_), side = window_side_px(schedule_.weighting(), grid.window_px);
    int const radius = schedule_.search_radius_px(pass);
    int const least = plane_transform_size(schedule_.weighting(), grid.window_px, radius),
              factored = factored_size(least);
    // Zero padding of uniform windows does not change a correlation, but changes the wave numbers of a phase
    // correlation.
    int const size = side < least && factored != 0 && !phase_only_ ? factored : least;
    PredictorView const predictor{grid, ghosts, grid.columns + 2 * ghosts, grid.rows + 2 * ghosts, nullptr};
    return {grid,
            radius,
            predictor,
            DeviceAxisWeights(AxisWeights(grid, GridAxis::x, columns_, schedule_.weighting())),
            DeviceAxisWeights(AxisWeights(grid, GridAxis::y, rows_, schedule_.weighting())),
            side,
            size,
            make_line_plan(size),
            on_device(unit_roots(size)),
            phase_only_ ? on_device(particle_spectrum(size)) : DeviceArray<float>()};
  }

  PredictorView predictor(int pass) const {
    PredictorView view = passes_[pass].predictor;
    view.nodes = extended_.data();
    return view;
  }

  PassPredictor deformed_by(int pass) const {
    return pass > 0 ? PassPredictor{predictor(pass - 1), true} : PassPredictor{{}, false};
  }

  AmbiguousPlaces before(int pass) const {
    return pass > 0 ? AmbiguousPlaces{passes_[pass - 1].grid, ambiguous_[(pass - 1) % 2].data()}
                    : AmbiguousPlaces{{}, nullptr};
  }

  void make_scratch() {
    std::size_t values = 0, windows = 0;
    for (Pass const& pass : passes_)
      if (factored_size(pass.size) != pass.size && !pass.lines.window_in_shared) {
        values = std::max(values, pass.lines.window_values());
        windows = std::max(windows, pass.grid.size());
      }
    scratch_.make(values, windows);
    Pass const& last = passes_.back();
    if (with_sigma_ && statistics_need_scratch(last.side))
      scratch_of_sigma_.make(statistics_values(last.side), last.grid.size());
    has_scratch_ = true;
  }

  void make_predictor_of(int pass) {
    make_predictor(vectors_.data(), nodes_.data(), known_.data(), list_.data(), list_size_.data(),
                   schedule_.smoothing(pass), predictor(pass), extended_.data());
  }

  bool has_steep_gradient() {
    int count = 0;
    count_steep(vectors_.data(), passes_.back().grid, list_size_.data());
    list_size_.download(&count, 1);
    return count > 0;
  }

  RefinedPass download_pass(std::size_t size) const {
    RefinedPass pass{std::vector<GridVector>(size), std::vector<WindowCorrelation>(size)};
    vectors_.download(pass.vectors.data(), size);
    windows_.download(pass.windows.data(), size);
    return pass;
  }

  /// Repeats the last pass where gradients are steep. Predictors are made and vectors are chosen by the host, with the
  /// functions that the CPU uses.
  void refine(BsplineView<float> const (&spline)[2], DevicePair const& original, DevicePair const& deformed) {
    Pass const& last = passes_.back();
    std::size_t const size = last.grid.size();
    RefinedPass pass = download_pass(size);
    PredictorView view = last.predictor;
    DeviceArray<Vec2d> extended(static_cast<std::size_t>(view.columns) * view.rows, purpose), nodes(size, purpose);
    view.nodes = extended.data();
    ValidationRule const rule = schedule_.rule(schedule_.passes() - 1);
    refine_steep_vectors(pass, last.grid, schedule_.steep_passes(), rule, [&](RefinementPlan const& plan) {
      throw_if_interrupted();
      nodes.upload(plan.nodes.data());
      DeviceArray<char> const before = on_device(plan.ambiguous);
      extend_predictor(nodes.data(), schedule_.steep_smoothing(), view, extended.data());
      deform_pair(spline[0], spline[1], schedule_.spline_degree(), original, view, deformed);
      correlate_windows(last, deformed);
      take_vectors(windows_.data(), vectors_.data(), last.grid, {view, true}, schedule_.limit_px(),
                   {last.grid, before.data()}, ambiguous_[0].data());
      validate(vectors_.data(), last.grid, rule, list_.data(), list_size_.data());
      return download_pass(size);
    });
    copy_to_device(vectors_.data(), pass.vectors.data(), size * sizeof(GridVector));
    copy_to_device(windows_.data(), pass.windows.data(), size * sizeof(WindowCorrelation));
  }

  void estimate_sigma_of(Pass const& pass, DevicePair const& matched) {
    MatchedWindows const windows{.pair = matched,
                                 .grid = pass.grid,
                                 .x = pass.x.view(),
                                 .y = pass.y.view(),
                                 .side = pass.side,
                                 .margin = (pass.x.view().size - pass.side) / 2,
                                 .vectors = vectors_.data(),
                                 .amplification = amplification_};
    estimate_sigma(windows, scratch_of_sigma_.memory.data(), scratch_of_sigma_.slots, variances_.data(), sigma_.data());
  }

  void correlate_windows(Pass const& pass, DevicePair const& pair) {
    WindowJob const job{.pair = pair,
                        .contrast = contrast_.data(),
                        .grid = pass.grid,
                        .x = pass.x.view(),
                        .y = pass.y.view(),
                        .side = pass.side,
                        .margin = (pass.x.view().size - pass.side) / 2,
                        .size = pass.size,
                        .roots = pass.roots.data(),
                        .particles = pass.particles.data(),
                        .search_radius_px = pass.search_radius_px};
    if (has_own_kernel(job))
      job.size == 64 ? correlate_windows_of_64(job, peaks_.data()) : correlate_windows_of_32(job, peaks_.data());
    else if (factored_size(job.size) == job.size)
      correlate_windows_by_factors(job, peaks_.data());
    else
      correlate_windows_by_lines(job, pass.lines, scratch_.memory.data(), scratch_.slots, peaks_.data());
    measure_peaks(job, peaks_.data(), nine_points_, windows_.data());
  }

  DownloadedVectors download() {
    DownloadedVectors vectors{passes_.back().grid, std::vector<MeasuredVector>(measured_.size()),
                              std::vector<Vec2d>(sigma_.size())};
    measured_.download(vectors.measured.data(), vectors.measured.size());
    sigma_.download(vectors.sigma_px.data(), vectors.sigma_px.size());
    return vectors;
  }

  /// Returns whether the frames are deformed at all.
  bool deforms() const { return schedule_.passes() > 1 || with_sigma_; }

  CorrelationSchedule schedule_;
  bool phase_only_, nine_points_;
  bool with_sigma_;  ///< whether sigma is estimated by correlation statistics after the last pass
  double amplification_;
  int columns_;
  int rows_;
  std::vector<Pass> passes_;
  DeviceArray<LevelKeys> keys_{1, purpose};
  DeviceArray<float> contrast_{1, purpose};
  Pair original_, deformed_;
  DeviceArray<double> uploaded_[2];
  DeviceArray<float> spline_[2];
  DeviceArray<float> taps_;
  DeviceArray<WindowCorrelation> windows_;
  DeviceArray<WindowPeaks> peaks_;
  DeviceArray<GridVector> vectors_;
  DeviceArray<char> ambiguous_[2];  ///< flags of ambiguous vectors of a pass and of the previous one
  DeviceArray<MeasuredVector> measured_;
  DeviceArray<Replacement> list_;
  DeviceArray<int> list_size_{1, purpose};
  DeviceArray<Vec2d> nodes_, extended_;
  DeviceArray<char> known_;
  DeviceArray<Vec2d> variances_, sigma_;
  WindowScratch scratch_, scratch_of_sigma_;
  bool has_scratch_ = false;
};

struct CudaCorrelator::State {
  explicit State(CorrelationSettings const& wanted) : settings(wanted) {}

  /// Returns the plan for images of this size. @throws DataError, OutOfDeviceMemory
  CorrelationPlan& plan_for(int columns, int rows) {
    if (!plan || !plan->suits(columns, rows)) {
      plan.reset();  // release its memory first
      plan = std::make_unique<CorrelationPlan>(settings, columns, rows);
    }
    return *plan;
  }

  CorrelationSettings settings;
  StagingPool staging;
  std::mutex busy;
  std::unique_ptr<CorrelationPlan> plan;
};

CudaCorrelator::CudaCorrelator(CorrelationSettings const& settings) : state_(std::make_unique<State>(settings)) {}

CudaCorrelator::~CudaCorrelator() = default;

DisplacementField CudaCorrelator::correlate(Image<double> const& reference, Image<double> const& flow) const {
  check_image_sizes(state_->settings, reference.columns(), reference.rows(), flow.columns(), flow.rows());
  DownloadedVectors vectors;
  {  // While the device works on one pair, other threads fill their buffers, and convert the vectors of earlier pairs.
    StagingPool::Buffer const staging = state_->staging.acquire();
    auto* const staged = static_cast<double*>(staging->reserve(2 * reference.size() * sizeof(double)));
    std::copy(flow.begin(), flow.end(), std::copy(reference.begin(), reference.end(), staged));
    std::lock_guard const lock(state_->busy);
    CorrelationPlan& plan = state_->plan_for(reference.columns(), reference.rows());
    plan.upload(staged);
    vectors = plan.correlate(plan.uploaded(0), plan.uploaded(1));
  }
  return std::move(vectors).field();
}

DisplacementField CudaCorrelator::correlate_pair(StoredFrames const& frames) const {
  auto const* const here = dynamic_cast<DeviceFrames const*>(&frames);
  return here ? correlate(here->image(Frame::reference), here->image(Frame::flow)) : Correlator::correlate_pair(frames);
}

DisplacementField CudaCorrelator::correlate(DeviceImage const& reference, DeviceImage const& flow) const {
  check_image_sizes(state_->settings, reference.columns, reference.rows, flow.columns, flow.rows);
  DownloadedVectors vectors;
  {
    std::lock_guard const lock(state_->busy);
    vectors = state_->plan_for(reference.columns, reference.rows).correlate(reference, flow);
  }
  return std::move(vectors).field();
}

void CudaCorrelator::enqueue(DeviceImage const& reference, DeviceImage const& flow) const {
  check_image_sizes(state_->settings, reference.columns, reference.rows, flow.columns, flow.rows);
  std::lock_guard const lock(state_->busy);
  state_->plan_for(reference.columns, reference.rows).enqueue(reference, flow);
}

}  // namespace gladstone::cuda::inline correlation
