#include "analysis/correlation/pattern_period.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/fourier_transform.h"
#include "analysis/correlation/peak_search.h"
#include "analysis/correlation/standard_correlator.h"
#include "analysis/correlation/window_pixels.h"

namespace gladstone::inline correlation {
namespace {

/// Returns a grid of windows over the whole image, at most four along each axis.
InterrogationGrid sampling_grid(int columns, int rows, int window_px) {
  InterrogationGrid grid = make_interrogation_grid(columns, rows, window_px, 0.5);
  grid.spacing_px = std::max(grid.spacing_px, (std::max(columns, rows) - window_px + 2) / 3);
  grid.columns = (columns - window_px) / grid.spacing_px + 1;
  grid.rows = (rows - window_px) / grid.spacing_px + 1;
  return grid;
}

/// Computes the autocorrelation planes of single windows; contains the scratch memory.
class Autocorrelation {
 public:
  explicit Autocorrelation(int size)
      : size_(size), values_(static_cast<std::size_t>(size) * size), spectrum_(values_.size()) {}

  /// Returns the plane of a window of frame A; the next call overwrites it.
  PlaneView<double> of(ImagePair const& pair, AxisWeightsView const& x, int column, AxisWeightsView const& y, int row) {
    double weights = 0.0, sum = 0.0;
    visit_window_pixels(pair, x, column, y, row, [&](int, int, float weight, std::size_t at) {
      weights += weight;
      sum += static_cast<double>(weight) * pair.reference[at];
    });
    float const mean = weights > 0.0 ? static_cast<float>(sum / weights) : 0.0f;
    std::fill(values_.begin(), values_.end(), 0.0);
    visit_window_pixels(pair, x, column, y, row, [&](int i, int j, float weight, std::size_t at) {
      values_[static_cast<std::size_t>(j) * size_ + i] = weight * (pair.reference[at] - mean);
    });
    fourier_transform(values_, spectrum_, size_, FourierDirection::forward);
    for (std::complex<double>& value : spectrum_) value = std::norm(value);
    fourier_transform(spectrum_, values_, size_, FourierDirection::inverse);
    return {reinterpret_cast<double const*>(values_.data()), size_, 2};
  }

 private:
  int size_;
  std::vector<std::complex<double>> values_, spectrum_;
};

/// Detection limit: minimum autocorrelation one pixel from shift 0, relative to that at shift 0, for a pattern to be
/// recognised. Uncorrelated pixel noise causes a scatter of 1/window_px at that shift (square root of the sum of w^8
/// over the sum of w^4 along both axes, w the Gaussian weights), and the largest value among some thousand shifts is
/// about five times this scatter.
double least_seen(int window_px) { return 8.0 / window_px; }

/// Returns the geometric mean of a peak's heights at one pixel from its centre along both axes, on the Gaussian through
/// its samples. The height at one pixel is the peak height times the square root of the product of the relative heights
/// of the two samples next to the highest one, along each axis.
/// @param shift_attenuation  factor by which the weights reduce the plane at the peak's shift; the result is divided by
///                          it
double height_beside(PlaneView<double> const& plane, PlanePeak<double> const& peak, double shift_attenuation) {
  double const centre = plane(peak.x, peak.y);
  double const beside[4] = {plane(peak.x - 1, peak.y), plane(peak.x + 1, peak.y), plane(peak.x, peak.y - 1),
                            plane(peak.x, peak.y + 1)};
  double product = 1.0;
  for (double const value : beside) product *= std::max(0.0, value) / centre;
  return peak.height / shift_attenuation * std::pow(product, 0.25);
}

}  // namespace

std::optional<PatternPeriod> pattern_period(Image<double> const& image, CorrelationSettings const& settings) {
  constexpr int fewest_px = 128;
  int const room = std::min(image.columns(), image.rows()) / 2 * 2;
  int const window = std::min(std::max(2 * settings.window_px.front(), fewest_px), room);
  int const range = CorrelationSchedule(settings).search_radius_px(0), radius = std::min(2 * range, window / 2);
  InterrogationGrid const grid = sampling_grid(image.columns(), image.rows(), window);
  AxisWeights const weights_x(grid, GridAxis::x, image.columns(), WindowWeighting::gaussian);
  AxisWeights const weights_y(grid, GridAxis::y, image.rows(), WindowWeighting::gaussian);
  AxisWeightsView const x = weights_x.view(), y = weights_y.view();
  ImagePair const pair = make_image_pair(image, image);
  Autocorrelation autocorrelation(x.size);
  std::size_t repeating = 0;
  std::optional<PatternPeriod> period;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      PlaneView<double> const plane = autocorrelation.of(pair, x, column, y, row);
      double const across = 0.5 * (plane(-1, 0) + plane(1, 0)), down = 0.5 * (plane(0, -1) + plane(0, 1));
      double const main = std::sqrt(std::max(0.0, across) * std::max(0.0, down));
      PeakList<double> const found = find_peaks(plane, radius);
      bool repeats = false;
      for (int k = 0; k < found.count; ++k) {
        PlanePeak<double> const& peak = found.peak[k];
        if (peak.x == 0 && peak.y == 0) continue;
        double const shift_attenuation = x.autocorrelation(column, peak.x) * y.autocorrelation(row, peak.y) /
                                         (x.autocorrelation(column, 0) * y.autocorrelation(row, 0));
        double const whole = peak.height / shift_attenuation / plane(0, 0);
        double const beside =
            main > least_seen(window) * plane(0, 0) ? height_beside(plane, peak, shift_attenuation) / main : 0.0;
        double const height = std::max(whole, beside);
        if (height < ambiguous_height_ratio) continue;
        repeats = true;
        RefinedPeak<double> const at = refined_peak(plane, peak.x, peak.y, plane(peak.x, peak.y));
        double const pitch = std::hypot(at.x, at.y);
        if (!period || pitch < period->pitch_px) period = {pitch, height};
      }
      repeating += repeats;
    }
  if (4 * repeating < grid.size()) return std::nullopt;
  return period;
}

}  // namespace gladstone::inline correlation
