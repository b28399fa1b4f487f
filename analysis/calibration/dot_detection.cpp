#include "analysis/calibration/dot_detection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace gladstone {
namespace {

constexpr double threshold_share = 0.25;  // of the brightest dot's peak over the background
constexpr double least_contrast = 8;      // of that peak over the noise
constexpr double smoothing_px = 0.8;      // of what the threshold is laid on, not of what is measured
constexpr double rounding = 0.5;          // noise that whole grey levels may hide
constexpr int least_area = 5;             // [px]
constexpr double blur_px = 4;             // that a dot's light reaches beyond the threshold
constexpr int ring_px = 5;                // width of the background's ring
constexpr int least_ring = 24;            // pixels of it, for a mean

/// A region above the threshold.
struct Region {
  cv::Point2d centre;
  double area, radius;
  cv::Rect box;
  double window = 0;  ///< radius of the window that its centroid is taken in [px]
};

double median(cv::Mat const& values) {
  std::vector<double> sorted(values.begin<double>(), values.end<double>());
  auto const middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

/// Grey levels with dots bright on a background of zero, and their noise.
struct Levels {
  cv::Mat values;
  double noise;
};

Levels bright_on_dark(Image<double> const& picture) {
  cv::Mat const raw(picture.rows(), picture.columns(), CV_64F, const_cast<double*>(picture.data()));
  double const background = median(raw);
  cv::Mat smooth;
  cv::GaussianBlur(raw, smooth, {}, smoothing_px);
  double low = 0, high = 0;
  cv::minMaxLoc(smooth, &low, &high);
  Levels levels;
  levels.values = high - background >= background - low ? cv::Mat(raw - background) : cv::Mat(background - raw);
  levels.noise = 1.4826 * median(cv::Mat(cv::abs(levels.values)));  // of normal noise
  // of which rounding to whole levels may leave nothing to see
  if (std::all_of(picture.begin(), picture.end(), [](double level) { return level == std::floor(level); })) {
    levels.noise = std::max(levels.noise, rounding);
  }
  return levels;
}

/// Regions of the size and shape of dots that lie wholly in the picture.
std::vector<Region> regions_of(Levels const& levels) {
  cv::Mat smooth;
  cv::GaussianBlur(levels.values, smooth, {}, smoothing_px);
  double peak = 0;
  cv::minMaxLoc(smooth, nullptr, &peak);
  std::vector<Region> regions;
  if (!(peak > least_contrast * levels.noise)) return regions;
  cv::Mat labels, statistics, centroids;
  cv::Mat const mask = smooth > threshold_share * peak;
  int const count = cv::connectedComponentsWithStats(mask, labels, statistics, centroids);
  for (int i = 1; i < count; ++i) {
    cv::Rect const box(statistics.at<int>(i, cv::CC_STAT_LEFT), statistics.at<int>(i, cv::CC_STAT_TOP),
                       statistics.at<int>(i, cv::CC_STAT_WIDTH), statistics.at<int>(i, cv::CC_STAT_HEIGHT));
    double const area = statistics.at<int>(i, cv::CC_STAT_AREA);
    bool const inside = box.x > 0 && box.y > 0 && box.br().x < mask.cols && box.br().y < mask.rows;
    if (area < least_area || !inside) continue;
    regions.push_back({{centroids.at<double>(i, 0), centroids.at<double>(i, 1)}, area, std::sqrt(area / CV_PI), box});
  }
  if (regions.empty()) return regions;
  std::vector<double> areas;
  for (Region const& region : regions) areas.push_back(region.area);
  std::nth_element(areas.begin(), areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2), areas.end());
  double const usual = areas[areas.size() / 2];
  std::erase_if(regions, [usual](Region const& region) {
    constexpr double most = 3;  // by which perspective and blur may change areas, and slant a disc's width and height
    double const wide = region.box.width, high = region.box.height;
    return region.area > most * usual || region.area < usual / most || wide > most * high || high > most * wide;
  });
  return regions;
}

/// Windows as wide as dots with their blur are, but at most half the way to the next dot.
void choose_windows(std::vector<Region>& regions) {
  for (Region& region : regions) {
    double nearest2 = std::numeric_limits<double>::infinity();
    for (Region const& other : regions) {
      if (&other == &region) continue;
      cv::Point2d const apart = other.centre - region.centre;
      nearest2 = std::min(nearest2, apart.dot(apart));
    }
    region.window = std::min(1.5 * region.radius + blur_px, 0.5 * std::sqrt(nearest2));
  }
}

/// Pixels that no window reaches.
cv::Mat background_of(std::vector<Region> const& regions, cv::Size size) {
  cv::Mat free(size, CV_8U, cv::Scalar(255));
  for (Region const& region : regions) {
    cv::circle(free, cv::Point(cvRound(region.centre.x), cvRound(region.centre.y)), cvCeil(region.window) + 1,
               cv::Scalar(0), cv::FILLED);
  }
  return free;
}

/// Mean background in a ring about a window.
double ring_mean(cv::Mat const& values, cv::Mat const& free, Region const& region) {
  double const outer = region.window + 1 + ring_px;
  int const left = std::max(0, cvFloor(region.centre.x - outer)), top = std::max(0, cvFloor(region.centre.y - outer));
  int const right = std::min(values.cols, cvCeil(region.centre.x + outer) + 1);
  int const low = std::min(values.rows, cvCeil(region.centre.y + outer) + 1);
  double sum = 0;
  int count = 0;
  for (int row = top; row < low; ++row) {
    for (int column = left; column < right; ++column) {
      if (free.at<unsigned char>(row, column) == 0) continue;
      sum += values.at<double>(row, column);
      ++count;
    }
  }
  return count >= least_ring ? sum / count : cv::mean(values, free)[0];
}

/// The centroid over the background in the region's window, moved to where it is. @return false where the window does
/// not lie in the picture
bool measure(cv::Mat const& values, double background, Region const& region, DetectedDot& dot) {
  cv::Point2d centre = region.centre;
  for (int round = 0; round < 10; ++round) {
    int const left = cvCeil(centre.x - region.window), right = cvFloor(centre.x + region.window);
    int const top = cvCeil(centre.y - region.window), low = cvFloor(centre.y + region.window);
    if (left < 0 || top < 0 || right >= values.cols || low >= values.rows) return false;
    double weight = 0;
    cv::Point2d moment(0, 0);
    for (int row = top; row <= low; ++row) {
      for (int column = left; column <= right; ++column) {
        cv::Point2d const at(column - centre.x, row - centre.y);
        if (at.dot(at) > region.window * region.window) continue;
        double const level = values.at<double>(row, column) - background;
        weight += level;
        moment += level * at;
      }
    }
    if (!(weight > 0)) return false;
    cv::Point2d const step = moment / weight;
    if (!(step.dot(step) < region.window * region.window)) return false;
    centre += step;
    dot = {{centre.x, centre.y}, weight, 2 * region.radius};
    if (step.dot(step) < 1e-12) break;
  }
  return true;
}

}  // namespace

std::vector<DetectedDot> detect_dots(Image<double> const& picture) {
  std::vector<DetectedDot> dots;
  if (picture.size() == 0) return dots;
  Levels const levels = bright_on_dark(picture);
  std::vector<Region> regions = regions_of(levels);
  choose_windows(regions);
  cv::Mat const free = background_of(regions, levels.values.size());
  for (Region const& region : regions) {
    DetectedDot dot;
    if (measure(levels.values, ring_mean(levels.values, free, region), region, dot)) dots.push_back(dot);
  }
  return dots;
}

}  // namespace gladstone
