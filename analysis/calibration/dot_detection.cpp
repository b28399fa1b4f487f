#include "analysis/calibration/dot_detection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/calibration/dot_regions.h"
#include "analysis/preparation/illumination.h"
#include "analysis/preparation/opencv_call.h"
#include "render/base/median.h"

namespace gladstone::inline calibration {
namespace {

// minimum standard deviation of the noise, assumed for images of integer grey levels, whose rounding may hide the noise
constexpr double rounding = 0.5;
constexpr int ring_px = 5;      // width of the ring around a dot in which the background is fitted [px]
constexpr int least_ring = 24;  // minimum number of background pixels for a plane fit
constexpr double wide = 3;  // radius of the region for a quadratic fit of the background, in outer radii of the ring
// maximum error of a quadratic fit at a dot's centre, and maximum error that its slope causes across the window, both
// in standard deviations of the noise of a pixel
constexpr double most_error = 0.25;
constexpr double most_residual = 3;  // maximum rms residual of a quadratic fit, in standard deviations of the noise
constexpr int reach_px = 4;          // distance to which light spreads beyond a region that is not a dot [px]

enum class Dots { bright, dark };

/// Image with subtracted background, and its noise.
struct LitPicture {
  Image<double> const& raw;
  Image<double> background;
  Image<double> over_background;  ///< grey levels minus background; inverted for dark dots
  Dots dots = Dots::bright;
  double noise = 0;
};

cv::Mat matrix_of(Image<double> const& image) {
  return {image.rows(), image.columns(), CV_64F, const_cast<double*>(image.data())};
}

double median_size(Image<double> const& levels) {
  std::vector<double> sizes;
  for (double const level : levels) sizes.push_back(std::abs(level));
  return upper_median(std::move(sizes));
}

LitPicture lit_picture(Image<double> const& picture) {
  LitPicture lit{picture, estimate_background(picture), picture};
  Image<double>& over = lit.over_background;
  for (std::size_t i = 0; i < over.size(); ++i) over.data()[i] -= lit.background.data()[i];
  cv::Mat smooth;
  cv::GaussianBlur(matrix_of(over), smooth, {}, dot_smoothing_px);
  double low = 0, high = 0;
  cv::minMaxLoc(smooth, &low, &high);
  lit.dots = high >= -low ? Dots::bright : Dots::dark;
  if (lit.dots == Dots::dark) {
    for (double& level : over) level = -level;
  }
  lit.noise = sigma_per_median_deviation * median_size(over);  // for normally distributed noise
  // If all grey levels are integers, rounding may hide all noise.
  if (std::all_of(picture.begin(), picture.end(), [](double level) { return level == std::floor(level); })) {
    lit.noise = std::max(lit.noise, rounding);
  }
  return lit;
}

/// Returns the mask of background pixels: those outside of all dot windows and of all other regions.
cv::Mat background_pixels(DotRegions& regions) {
  Image<unsigned char>& others = regions.not_dots;
  cv::Mat reached;
  cv::dilate(cv::Mat(others.rows(), others.columns(), CV_8U, others.data()), reached,
             cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * reach_px + 1, 2 * reach_px + 1}));
  cv::Mat free = reached == 0;
  for (DotRegion const& dot : regions.dots) {
    cv::circle(free, cv::Point(cvRound(dot.centre.x), cvRound(dot.centre.y)), cvCeil(dot.window) + 1, cv::Scalar(0),
               cv::FILLED);
  }
  return free;
}

/// Grey levels of the background: a polynomial of first or second order around a point.
struct LevelSurface {
  Vec2d about{};
  double level = 0;
  Vec2d slope{};
  double xx = 0, xy = 0, yy = 0;  ///< coefficients of the second-order terms

  double at(double column, double row) const {
    double const x = column - about.x, y = row - about.y;
    return level + slope.x * x + slope.y * y + xx * x * x + xy * x * y + yy * y * y;
  }
};

/// Returns a plane tangent to the estimated background at a point, shifted by the mean error over the background
/// pixels.
LevelSurface estimated_plane(LitPicture const& lit, double mean_error, Vec2d about) {
  Image<double> const& ground = lit.background;
  int const column = std::clamp(cvRound(about.x), 1, ground.columns() - 2);
  int const row = std::clamp(cvRound(about.y), 1, ground.rows() - 2);
  auto const level = [&](int x, int y) { return ground(x, y); };
  LevelSurface plane{{static_cast<double>(column), static_cast<double>(row)}, level(column, row) + mean_error};
  plane.slope = {0.5 * (level(column + 1, row) - level(column - 1, row)),
                 0.5 * (level(column, row + 1) - level(column, row - 1))};
  return plane;
}

/// Sums of a least-squares fit to background pixels.
template <int terms>
struct FitSums {
  Eigen::Matrix<double, terms, terms> normal = Eigen::Matrix<double, terms, terms>::Zero();
  Eigen::Matrix<double, terms, 1> moment = Eigen::Matrix<double, terms, 1>::Zero();
  double squares = 0;

  double count() const { return normal(0, 0); }
};

/// Sums the background pixels in a square around a dot.
/// @param term  computes the terms of the fit at an offset from the dot's centre; the first term is 1
template <int terms, class Term>
FitSums<terms> sum_background(LitPicture const& lit, cv::Mat const& free, Vec2d centre, double reach,
                              Term const& term) {
  int const left = std::max(0, cvFloor(centre.x - reach)), top = std::max(0, cvFloor(centre.y - reach));
  int const right = std::min(free.cols, cvCeil(centre.x + reach) + 1);
  int const low = std::min(free.rows, cvCeil(centre.y + reach) + 1);
  FitSums<terms> sums;
  for (int row = top; row < low; ++row) {
    for (int column = left; column < right; ++column) {
      if (free.at<unsigned char>(row, column) == 0) continue;
      Eigen::Matrix<double, terms, 1> const values = term(column - centre.x, row - centre.y);
      double const level = lit.raw(column, row);
      sums.normal += values * values.transpose();
      sums.moment += level * values;
      sums.squares += level * level;
    }
  }
  return sums;
}

/// Fits a quadratic polynomial to the background in the wider surroundings of a dot.
/// @return nullopt if the background pixels do not determine the polynomial at the dot, or if its residual at these
///         pixels is too large
std::optional<LevelSurface> quadratic_background(LitPicture const& lit, cv::Mat const& free, DotRegion const& dot) {
  constexpr int terms = 6;
  double const reach = wide * (dot.window + 1 + ring_px);
  auto const sums = sum_background<terms>(lit, free, dot.centre, reach, [reach](double x, double y) {
    double const u = x / reach, v = y / reach;
    return Eigen::Matrix<double, terms, 1>(1, u, v, u * u, u * v, v * v);
  });
  if (sums.count() < least_ring) return std::nullopt;
  Eigen::LDLT<Eigen::Matrix<double, terms, terms>> const solver(sums.normal);
  if (solver.info() != Eigen::Success || !(solver.rcond() > 1e-9)) return std::nullopt;
  Eigen::Matrix<double, terms, terms> const covariance = solver.solve(Eigen::Matrix<double, terms, terms>::Identity());
  double const steepest = std::sqrt(std::max(covariance(1, 1), covariance(2, 2))) * dot.window / reach;
  if (!(std::sqrt(covariance(0, 0)) < most_error) || !(steepest < most_error)) return std::nullopt;
  Eigen::Matrix<double, terms, 1> const fitted = solver.solve(sums.moment);
  double const residual2 = (sums.squares - fitted.dot(sums.moment)) / sums.count();
  if (!(residual2 <= std::pow(most_residual * lit.noise, 2))) return std::nullopt;
  double const reach2 = reach * reach;
  return LevelSurface{dot.centre,         fitted(0),          {fitted(1) / reach, fitted(2) / reach},
                      fitted(3) / reach2, fitted(4) / reach2, fitted(5) / reach2};
}

/// Fits a plane to the background in the ring around a dot's window. If the ring has too few background pixels or has
/// them on one side only, falls back to a quadratic polynomial in the wider surroundings, then to the estimated
/// background.
LevelSurface background_surface(LitPicture const& lit, cv::Mat const& free, double mean_error, DotRegion const& dot) {
  auto const sums = sum_background<3>(lit, free, dot.centre, dot.window + 1 + ring_px,
                                      [](double x, double y) { return Eigen::Vector3d(1, x, y); });
  // The background pixels must surround the dot rather than be on one side of it.
  bool const about = std::hypot(sums.normal(0, 1), sums.normal(0, 2)) < 0.5 * dot.window * sums.count();
  if (sums.count() < least_ring || !about) {
    return quadratic_background(lit, free, dot).value_or(estimated_plane(lit, mean_error, dot.centre));
  }
  Eigen::Vector3d const plane = sums.normal.ldlt().solve(sums.moment);
  return {dot.centre, plane(0), {plane(1), plane(2)}};
}

/// Computes the centroid of the levels above the background, re-centring the window until it converges.
/// @return false if the window extends beyond the image
bool measure(LitPicture const& lit, LevelSurface const& background, DotRegion const& region, DetectedDot& measured) {
  Vec2d centre = region.centre;
  for (int round = 0; round < 10; ++round) {
    int const left = cvCeil(centre.x - region.window), right = cvFloor(centre.x + region.window);
    int const top = cvCeil(centre.y - region.window), low = cvFloor(centre.y + region.window);
    if (left < 0 || top < 0 || right >= lit.raw.columns() || low >= lit.raw.rows()) return false;
    double weight = 0;
    Vec2d moment{};
    for (int row = top; row <= low; ++row) {
      for (int column = left; column <= right; ++column) {
        Vec2d const at{column - centre.x, row - centre.y};
        if (dot(at, at) > region.window * region.window) continue;
        double const ground = background.at(column, row), raw = lit.raw(column, row);
        double level = raw - ground;
        if (lit.dots == Dots::dark)
          level = ground > 0 && background.level > 0 ? -level * background.level / ground : -level;
        weight += level;
        moment += level * at;
      }
    }
    if (!(weight > 0)) return false;
    Vec2d const step = moment / weight;
    if (!(dot(step, step) < region.window * region.window)) return false;
    centre += step;
    measured = {centre, weight, 2 * region.radius};
    if (dot(step, step) < 1e-12) break;
  }
  return true;
}

DetectedDots find_dots(Image<double> const& picture) {
  DetectedDots found;
  if (picture.columns() < 3 || picture.rows() < 3) return found;
  LitPicture const lit = lit_picture(picture);
  DotRegions regions = find_dot_regions(lit.over_background, lit.noise);
  found.not_dots = regions.others;
  cv::Mat const free = background_pixels(regions);
  double const mean_over = cv::mean(matrix_of(lit.over_background), free)[0];
  double const mean_error = lit.dots == Dots::bright ? mean_over : -mean_over;
  for (DotRegion const& region : regions.dots) {
    DetectedDot dot;
    if (measure(lit, background_surface(lit, free, mean_error, region), region, dot)) found.dots.push_back(dot);
  }
  return found;
}

}  // namespace

DetectedDots detect_dots(Image<double> const& picture) {
  return call_opencv(ErrorCode::internal, "image", "detect dots", [&] { return find_dots(picture); });
}

}  // namespace gladstone::inline calibration
