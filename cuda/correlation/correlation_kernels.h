#pragma once

#include <vector>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/bspline_image.h"
#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/predictor_view.h"
#include "analysis/correlation/standard_correlator.h"
#include "analysis/correlation/vector_validation.h"
#include "analysis/correlation/window_measurement.h"
#include "cuda/correlation/cuda_correlator.h"
#include "cuda/correlation/small_transform.h"

/// The launches that a correlation consists of, in the order of their calls. All pointers are device addresses; all
/// work is queued on the default stream, checked at its launch.
namespace gladstone::cuda {

/// Extreme finite grey levels of a pair as numbers that order alike: keys of the highest and of minus the lowest.
struct LevelKeys {
  unsigned long long highest;
  unsigned long long minus_lowest;
};

/// One pixel of both images, read at once.
struct alignas(8) GreyPair {
  float reference;
  float flow;
};

/// A pair as a pass reads it: joint grey level removed and divided by a power of two, so that its contrast is in [1, 2)
/// for any unit of grey; NaN where a pixel is not known.
struct DevicePair {
  GreyPair* pixels;
  int columns;
  int rows;
};

/// Brings images to this form. @param keys scratch @param contrast receives the largest minus the smallest level
void prepare_pair(DeviceImage const& reference, DeviceImage const& flow, LevelKeys* keys, float* contrast,
                  DevicePair const& pair);

/// B-spline coefficients of both images, unknown pixels taken as 0.
/// @param taps         of bspline_taps, `tap_count` of them
/// @param scratch      columns * rows values
/// @param coefficients of each image (columns + 12) * (rows + 12) values, as BsplineView lays them out
void filter_pair(DevicePair const& pair, float const* taps, int tap_count, GreyPair* scratch,
                 float* const (&coefficients)[2], BsplineView<float> (&spline)[2]);

/// All windows of a pass.
struct WindowJob {
  DevicePair pair;
  float const* contrast;
  InterrogationGrid grid;
  AxisWeightsView x;
  AxisWeightsView y;
  int side;                ///< of the pixels that have weight [px]
  int margin;              ///< of the support, beside them: (x.size - side)/2
  int size;                ///< length of the transforms
  Complex const* roots;    ///< unit_roots(size)
  float const* particles;  ///< of rpc: the spectrum that weighs the phases, along one axis; null: scc
  int search_radius_px;
};

/// A peak of a correlation plane: its highest sample and those around it.
struct PeakSample {
  int x, y;
  float height;       ///< between the samples
  float value[3][3];  ///< rows downwards
};

/// What a window's plane leaves behind to be measured.
struct WindowPeaks {
  WindowCorrelation::Outcome outcome;
  int count;
  double scale;  ///< makes the heights correlation coefficients
  PeakSample peak[3];
};

/// Whether job has a kernel of its own: scc of supports of 32 and 64 px.
bool has_own_kernel(WindowJob const& job);
/// Finds the peaks of every window of such a support, to be measured.
void correlate_windows_of_32(WindowJob const& job, WindowPeaks* peaks);
void correlate_windows_of_64(WindowJob const& job, WindowPeaks* peaks);

/// The smallest length of a transform with factors that are known to the compiler, 32 to 128, that is no less; 0: none.
int factored_size(int least);
/// @pre factored_size(job.size) == job.size
void correlate_windows_by_factors(WindowJob const& job, WindowPeaks* peaks);

/// Transforms of any size, line by line in shared memory.
struct LinePlan {
  static constexpr int most_stages = 10;
  int size;
  int radix[most_stages];
  int stages;
  int warps;                 ///< of a block
  std::size_t shared_bytes;  ///< of a block
  bool window_in_shared;     ///< else a window of pitch() * size complex values lies in `scratch`
  GLADSTONE_HD int pitch() const { return size + 1; }
  std::size_t window_values() const { return 2 * static_cast<std::size_t>(pitch()) * static_cast<std::size_t>(size); }
};
LinePlan make_line_plan(int size);
/// exp(-2 pi i k / size).
std::vector<Complex> unit_roots(int size);
/// @param scratch plan.window_values() for each of `slots` windows that are worked on together
void correlate_windows_by_lines(WindowJob const& job, LinePlan const& plan, float* scratch, int slots,
                                WindowPeaks* peaks);

/// Turns the peaks into shifts between the pixels by three points along either axis (gauss3) or nine (gauss2d).
void measure_peaks(WindowJob const& job, WindowPeaks const* peaks, bool nine_points, WindowCorrelation* results);

/// A vector or node that is being replaced.
struct Replacement {
  int index;
  FailedTest failed;
  enum State : int { open, found, done } state;
  VectorReplacement by;
};

/// What a pass was deformed by.
struct PassPredictor {
  PredictorView view;
  bool any;  ///< false in the first pass: the images are as they were taken
  GLADSTONE_HD Vec2d at(Vec2d position_px) const { return any ? view.at(position_px) : Vec2d{}; }
};
/// Turns the results of a pass into vectors. @param ambiguous receives a flag for each
void take_vectors(WindowCorrelation const* windows, GridVector* vectors, InterrogationGrid const& grid,
                  PassPredictor const& predictor, double limit_px, AmbiguousPlaces const& before, char* ambiguous);
/// Validates the vectors of a pass. @param list, count scratch: a place for every vector
void validate(GridVector* vectors, InterrogationGrid const& grid, ValidationRule const& rule, Replacement* list,
              int* count);
/// What the last pass tells of every vector.
void finish(WindowCorrelation const* windows, GridVector const* vectors, InterrogationGrid const& grid,
            MeasuredVector* measured);
/// The vectors as the next pass' predictor: filled, smoothed, continued past the image.
/// @param nodes, known, list, count scratch: a place for every vector
/// @param smoothing CorrelationSchedule::smoothing()
/// @param extended  predictor.columns * predictor.rows, where predictor.nodes points
void make_predictor(GridVector const* vectors, Vec2d* nodes, char* known, Replacement* list, int* count,
                    double smoothing, PredictorView const& predictor, Vec2d* extended);
/// Deforms the original pair.
void deform_pair(BsplineView<float> const& reference, BsplineView<float> const& flow, int degree,
                 DevicePair const& original, PredictorView const& predictor, DevicePair const& deformed);

}  // namespace gladstone::cuda
