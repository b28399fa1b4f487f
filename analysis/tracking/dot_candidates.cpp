#include "analysis/tracking/dot_candidates.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "analysis/preparation/grey_levels.h"
#include "analysis/preparation/illumination.h"
#include "analysis/preparation/opencv_call.h"
#include "render/base/median.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"

namespace gladstone::inline tracking {
namespace {

constexpr double rounding_noise = 0.28867513459481288;  // noise of rounding to integers, 1 / sqrt(12) [grey levels]
constexpr double filter_share = 0.7;                    // ratio of the filter's width to that of the dots
constexpr double usual_sigma = 0.75;  // standard deviation of a dot image if the frame does not determine it [px]

std::vector<double> finite_levels(Image<double> const& levels) {
  std::vector<double> finite;
  for (double const level : levels)
    if (std::isfinite(level)) finite.push_back(level);
  return finite;
}

/// Returns the number of rows and columns of the Gaussian filter.
int filter_side(double sigma) { return 2 * static_cast<int>(std::ceil(4 * sigma)) + 1; }

/// Filters an image by a Gaussian; ignored pixels count as background.
Image<double> filtered(Image<double> const& levels, double sigma) {
  Image<double> known = levels, smooth(levels.columns(), levels.rows());
  for (double& level : known)
    if (!std::isfinite(level)) level = 0;
  cv::Mat1d out = matrix_view<cv::Mat1d>(smooth);
  int const side = filter_side(sigma);
  call_opencv(ErrorCode::internal, "image", "filter the frames", [&] {
    cv::GaussianBlur(matrix_view<cv::Mat1d>(known), out, {side, side}, sigma, sigma, cv::BORDER_REFLECT_101);
  });
  return smooth;
}

/// Returns the factor by which the filter reduces the standard deviation of uncorrelated noise.
double noise_reduction(double sigma) {
  return call_opencv(ErrorCode::internal, "image", "filter the frames", [&] {
    cv::Mat const kernel = cv::getGaussianKernel(filter_side(sigma), sigma, CV_64F);
    // for a separable kernel, equals the root of the sum of squares of the two-dimensional kernel
    return kernel.dot(kernel);
  });
}

/// Returns the offset of the vertex of the parabola through three levels, at most half a pixel.
double vertex(double before, double here, double after) {
  double const curvature = 2 * here - before - after;
  return curvature > 0 ? std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5) : 0.0;
}

}  // namespace

DotFrame prepare_dot_frame(Image<double> const& frame, DotSettings const& settings) {
  DotFrame prepared;
  Image<double> known = frame;
  double const middle = upper_median(finite_levels(frame));
  for (double& level : known)
    if (!std::isfinite(level)) level = middle;
  Image<double> const background = estimate_background(known);
  prepared.above = Image<double>(frame.columns(), frame.rows());
  for (std::size_t i = 0; i < frame.size(); ++i) {
    double const level = frame.data()[i];
    prepared.above.data()[i] = std::isfinite(level) ? level - background.data()[i] : not_a_number;
  }
  prepared.bright = settings.polarity == DotPolarity::bright;
  if (settings.polarity == DotPolarity::automatic) {
    Image<double> const smooth = filtered(prepared.above, 0.8);
    auto const [low, high] = std::minmax_element(smooth.begin(), smooth.end());
    prepared.bright = *high >= -*low;
  }
  if (!prepared.bright)
    for (double& level : prepared.above) level = -level;
  std::vector<double> below;
  for (double const level : prepared.above)
    if (level <= 0) below.push_back(-level);
  prepared.noise = sigma_per_median_deviation * upper_median(std::move(below));
  return prepared;
}

double estimate_noise(Image<double> const& residual, bool whole_levels) {
  std::vector<double> values = finite_levels(residual);
  double const middle = upper_median(values);
  for (double& value : values) value = std::abs(value - middle);
  return std::max(sigma_per_median_deviation * upper_median(std::move(values)), whole_levels ? rounding_noise : 0.0);
}

double estimate_dot_sigma(Image<double> const& above) {
  double sum = 0, count = 0;
  for (double const level : above) {
    if (!std::isfinite(level)) continue;
    sum += level;
    ++count;
  }
  double const mean = count > 0 ? sum / count : 0;
  auto const correlation = [&](int shift) {
    double total = 0;
    for (int row = 0; row < above.rows(); ++row)
      for (int column = 0; column < above.columns(); ++column) {
        double const here = above(column, row) - mean;
        if (!std::isfinite(here)) continue;
        double const right = column + shift < above.columns() ? above(column + shift, row) - mean : not_a_number;
        double const low = row + shift < above.rows() ? above(column, row + shift) - mean : not_a_number;
        if (std::isfinite(right)) total += here * right;
        if (std::isfinite(low)) total += here * low;
      }
    return total;
  };
  double const one = correlation(1), two = correlation(2);
  if (!(one > 0)) return usual_sigma;
  // For dots of about one pixel, the autocorrelation at a shift of two pixels is near or below zero.
  double const ratio = std::log(one / std::max(two, 1e-3 * one));
  if (!(ratio > 0)) return usual_sigma;  // the frame contains noise only
  return std::clamp(std::sqrt(0.75 / ratio), 0.3, 10.0);
}

std::vector<GaussianDot> find_dot_candidates(DotFrame const& frame, double sigma_px, double detection_threshold) {
  double const width = filter_share * sigma_px;
  Image<double> const smooth = filtered(frame.above, width);
  double const threshold = detection_threshold * frame.noise * noise_reduction(width);
  // Ratio of a Gaussian dot's flux to its height after the filter; the integration over pixels adds 1/12 px^2.
  double const variance = sigma_px * sigma_px + width * width + 1.0 / 12;
  double const flux_per_height = 2 * pi * variance;
  std::vector<GaussianDot> found;
  for (int row = 1; row + 1 < smooth.rows(); ++row)
    for (int column = 1; column + 1 < smooth.columns(); ++column) {
      double const here = smooth(column, row);
      if (!(here > threshold) || !(here > 0)) continue;
      bool highest = true;
      for (int dy = -1; dy <= 1 && highest; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          bool const before = dy < 0 || (dy == 0 && dx < 0);
          double const other = smooth(column + dx, row + dy);
          if ((dx != 0 || dy != 0) && (other > here || (before && other == here))) highest = false;
        }
      if (!highest) continue;
      Vec2d const centre{column + vertex(smooth(column - 1, row), here, smooth(column + 1, row)),
                         row + vertex(smooth(column, row - 1), here, smooth(column, row + 1))};
      found.push_back({centre, here * flux_per_height, sigma_px * sigma_px, 0, sigma_px * sigma_px});
    }
  return found;
}

}  // namespace gladstone::inline tracking
