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

/// Kernel launches of a correlation, in the order of their calls. All pointers are device addresses; all work is queued
/// on the default stream and checked at launch.
namespace gladstone::cuda::inline correlation {

/// Highest finite grey level of an image pair and negative of the lowest, both as keys of ordered_key().
struct LevelKeys {
  unsigned long long highest;
  unsigned long long minus_lowest;
};

/// Pixel of both images, read in one access.
struct alignas(8) GreyPair {
  float reference;
  float flow;
};

/// Image pair in the form used by a pass: common grey level subtracted and scaled by a power of two, so that the
/// contrast is in [1, 2) for any unit of grey levels. Unknown pixels are NaN.
struct DevicePair {
  GreyPair* pixels;
  int columns;
  int rows;
};

/// Converts images to a DevicePair.
/// @param keys  scratch
/// @param contrast  output: scaled range of the grey levels
void prepare_pair(DeviceImage const& reference, DeviceImage const& flow, LevelKeys* keys, float* contrast,
                  DevicePair const& pair);

/// Computes the B-spline coefficients of both images; unknown pixels count as 0.
/// @param taps  `tap_count` values of bspline_taps()
/// @param scratch  columns * rows values
/// @param coefficients  output for each image: (columns + 12) * (rows + 12) values in the layout of BsplineView
/// @param spline  output: views of the coefficients
void filter_pair(DevicePair const& pair, float const* taps, int tap_count, GreyPair* scratch,
                 float* const (&coefficients)[2], BsplineView<float> (&spline)[2]);

/// Task of one pass: correlate all windows of a grid.
struct WindowJob {
  DevicePair pair;
  float const* contrast;
  InterrogationGrid grid;
  AxisWeightsView x;
  AxisWeightsView y;
  int side;                ///< side of the square of pixels with non-zero weight [px]
  int margin;              ///< zero-weight pixels on either side of the square: (x.size - side)/2
  int size;                ///< length of the transforms
  Complex const* roots;    ///< unit_roots(size)
  float const* particles;  ///< spectrum that weights the phases of rpc along one axis; null: scc
  int search_radius_px;
};

/// Peak of a correlation plane: its highest sample and those around it.
struct PeakSample {
  int x, y;
  float height;       ///< height interpolated between the samples
  float value[3][3];  ///< samples around the peak, rows downwards
};

/// Peaks of a window's plane, to be measured by measure_peaks().
struct WindowPeaks {
  WindowCorrelation::Outcome outcome;
  int count;
  double scale;  ///< factor that converts heights to correlation coefficients
  PeakSample peak[3];
};

/// Returns whether a specialised kernel exists for the job: scc with supports of 32 and 64 px.
bool has_own_kernel(WindowJob const& job);
/// Finds the peaks of all windows whose weights extend over 32 px. @pre has_own_kernel(job)
void correlate_windows_of_32(WindowJob const& job, WindowPeaks* peaks);
void correlate_windows_of_64(WindowJob const& job, WindowPeaks* peaks);

/// Returns the smallest transform length with compile-time factors (32 to 128) that is at least `least`; 0 if there is
/// none.
int factored_size(int least);
/// Finds the peaks of all windows. @pre factored_size(job.size) == job.size
void correlate_windows_by_factors(WindowJob const& job, WindowPeaks* peaks);

/// Configuration of transforms of any size, line by line in shared memory.
struct LinePlan {
  static constexpr int most_stages = 10;
  int size;
  int radix[most_stages];
  int stages;
  int warps;                 ///< number of warps per block
  std::size_t shared_bytes;  ///< shared memory per block [bytes]
  bool window_in_shared;     ///< false: a window of pitch() * size complex values is in `scratch`
  GLADSTONE_HD int pitch() const { return size + 1; }
  std::size_t window_values() const { return 2 * static_cast<std::size_t>(pitch()) * static_cast<std::size_t>(size); }
};
LinePlan make_line_plan(int size);
/// Returns exp(-2 pi i k / size) for 0 <= k < size.
std::vector<Complex> unit_roots(int size);
/// Finds the peaks of all windows, for any transform length.
/// @param scratch  plan.window_values() for each of `slots` concurrent windows
void correlate_windows_by_lines(WindowJob const& job, LinePlan const& plan, float* scratch, int slots,
                                WindowPeaks* peaks);

/// Measures the subpixel positions of the peaks by three points along each axis (gauss3) or by nine points (gauss2d).
void measure_peaks(WindowJob const& job, WindowPeaks const* peaks, bool nine_points, WindowCorrelation* results);

/// Vector, or node of the predictor, to be replaced.
struct Replacement {
  int index;
  FailedTest failed;
  enum State : int { open, found, done } state;
  VectorReplacement by;
};

/// Predictor by which the images of a pass were deformed.
struct PassPredictor {
  PredictorView view;
  bool any;  ///< false in the first pass, whose images are not deformed
  GLADSTONE_HD Vec2d at(Vec2d position_px) const { return any ? view.at(position_px) : Vec2d{}; }
};
/// Converts the results of a pass to vectors. @param ambiguous  output: one flag per vector
void take_vectors(WindowCorrelation const* windows, GridVector* vectors, InterrogationGrid const& grid,
                  PassPredictor const& predictor, double limit_px, AmbiguousPlaces const& before, char* ambiguous);
/// Validates the vectors of a pass. @param list, count  scratch: `list` has one element per vector
void validate(GridVector* vectors, InterrogationGrid const& grid, ValidationRule const& rule, Replacement* list,
              int* count);
/// Counts the vectors at a steep gradient, see is_steep(). @param count  output: one number in device memory
void count_steep(GridVector const* vectors, InterrogationGrid const& grid, int* count);
/// Writes the final result of every vector after the last pass.
void finish(WindowCorrelation const* windows, GridVector const* vectors, InterrogationGrid const& grid,
            MeasuredVector* measured);
/// Converts the vectors to the predictor of the next pass: fills gaps, smooths, and extrapolates beyond the image.
/// @param nodes, known, list, count  scratch, one element per vector (`count`: one)
/// @param smoothing  weight of CorrelationSchedule::smoothing()
/// @param extended  output: predictor.columns * predictor.rows nodes, the memory of predictor.nodes
void make_predictor(GridVector const* vectors, Vec2d* nodes, char* known, Replacement* list, int* count,
                    double smoothing, PredictorView const& predictor, Vec2d* extended);
/// Smooths nodes without gaps and extrapolates them beyond the image.
/// @param nodes  one element per vector
/// @param extended  output: predictor.columns * predictor.rows nodes, the memory of predictor.nodes
void extend_predictor(Vec2d const* nodes, double smoothing, PredictorView const& predictor, Vec2d* extended);
/// Deforms the original pair by the predictor.
void deform_pair(BsplineView<float> const& reference, BsplineView<float> const& flow, int degree,
                 DevicePair const& original, PredictorView const& predictor, DevicePair const& deformed);

}  // namespace gladstone::cuda::inline correlation
