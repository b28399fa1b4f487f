#include "analysis/calibration/dot_regions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "render/base/median.h"

namespace gladstone::inline calibration {
namespace {

constexpr double least_contrast = 8;  // minimum ratio of the dots' peak height to the standard deviation of the noise
constexpr double threshold_share = 0.25;  // threshold of the region search relative to the dots' peak height
constexpr double least_area = 5;          // minimum area of a dot's region [px^2]
constexpr double blur_px = 4;             // distance to which a dot's light spreads beyond the contour at the threshold
constexpr double area_factor = 3;    // maximum ratio of a dot's area to the median area, or of the median to the dot's;
                                     // perspective and blur cause differences
constexpr double axes_factor = 1.5;  // maximum ratio of a region's axis ratio to the median one
// minimum ratio of a region's area to that of the ellipse of its second moments
constexpr double least_fill = 0.9;

/// Size and shape of the part of a region that exceeds half the region's peak height.
struct Shape {
  Vec2d centre;
  double area, fill, axes;
};

struct Labels {
  cv::Mat labels, statistics;
  int count = 0;

  cv::Rect box(int label) const {
    return {statistics.at<int>(label, cv::CC_STAT_LEFT), statistics.at<int>(label, cv::CC_STAT_TOP),
            statistics.at<int>(label, cv::CC_STAT_WIDTH), statistics.at<int>(label, cv::CC_STAT_HEIGHT)};
  }
  double area(int label) const { return statistics.at<int>(label, cv::CC_STAT_AREA); }
};

Labels label_regions(cv::Mat const& mask) {
  Labels found;
  cv::Mat centroids;
  found.count = cv::connectedComponentsWithStats(mask, found.labels, found.statistics, centroids);
  return found;
}

double highest(cv::Mat const& smooth, Labels const& regions, int label) {
  cv::Rect const box = regions.box(label);
  double height = 0;
  cv::minMaxLoc(smooth(box), nullptr, &height, nullptr, nullptr, regions.labels(box) == label);
  return height;
}

/// Returns the area-weighted median of the regions' heights, which is insensitive to glints and faint dirt.
double usual_height(cv::Mat const& smooth, double noise) {
  Labels const regions = label_regions(smooth > least_contrast * noise);
  std::vector<std::pair<double, double>> heights;
  double all = 0;
  for (int label = 1; label < regions.count; ++label) {
    if (regions.area(label) < least_area) continue;
    heights.emplace_back(highest(smooth, regions, label), regions.area(label));
    all += regions.area(label);
  }
  std::sort(heights.begin(), heights.end());
  double sum = 0;
  for (auto const& [height, area] : heights) {
    sum += area;
    if (2 * sum >= all) return height;
  }
  return 0;
}

Shape shape_of(cv::Mat const& smooth, Labels const& regions, int label, double threshold) {
  cv::Rect const box = regions.box(label);
  double const half = std::max(threshold, 0.5 * highest(smooth, regions, label));
  double count = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  for (int row = box.y; row < box.br().y; ++row) {
    for (int column = box.x; column < box.br().x; ++column) {
      if (regions.labels.at<int>(row, column) != label || !(smooth.at<double>(row, column) > half)) continue;
      double const u = column - box.x, v = row - box.y;
      ++count;
      x += u;
      y += v;
      xx += u * u;
      xy += u * v;
      yy += v * v;
    }
  }
  x /= count;
  y /= count;
  constexpr double pixel = 1.0 / 12;  // second moment of a pixel about its centre [px^2]
  double const a = xx / count - x * x + pixel, b = yy / count - y * y + pixel, c = xy / count - x * y;
  double const mean = 0.5 * (a + b), apart = std::hypot(0.5 * (a - b), c);
  double const fill = count / (4 * CV_PI * std::sqrt(std::max(a * b - c * c, pixel * pixel)));
  double const axes = std::sqrt((mean + apart) / std::max(mean - apart, pixel));
  return {{box.x + x, box.y + y}, count, fill, axes};
}

template <class Value>
double median_of(std::vector<Shape> const& shapes, Value const& value) {
  std::vector<double> values;
  for (Shape const& shape : shapes) values.push_back(value(shape));
  return upper_median(std::move(values));
}

/// Returns true if the size and the shape of a region are close to the medians over all regions. The tolerances
/// increase with the inverse of the diameter, since the shape of a small region depends on the pixel grid.
bool looks_like(Shape const& shape, double usual_area, double usual_axes) {
  double const one_pixel = 1 / std::sqrt(shape.area);
  double const area = shape.area / usual_area, axes = shape.axes / usual_axes, most = axes_factor + 2 * one_pixel;
  return area < area_factor && area > 1 / area_factor && axes < most && axes > 1 / most &&
         shape.fill > least_fill - one_pixel;
}

/// Sets the window radius to that of the blurred dot, but at most to half the distance to the nearest dot.
void choose_windows(std::vector<DotRegion>& dots) {
  for (DotRegion& dot : dots) {
    double nearest2 = std::numeric_limits<double>::infinity();
    for (DotRegion const& other : dots) {
      if (&other == &dot) continue;
      Vec2d const apart = other.centre - dot.centre;
      nearest2 = std::min(nearest2, gladstone::dot(apart, apart));
    }
    dot.window = std::min(1.5 * dot.radius + blur_px, 0.5 * std::sqrt(nearest2));
  }
}

}  // namespace

DotRegions find_dot_regions(Image<double> const& levels, double noise) {
  DotRegions found;
  found.not_dots = Image<unsigned char>(levels.columns(), levels.rows());
  cv::Mat smooth;
  cv::GaussianBlur(cv::Mat(levels.rows(), levels.columns(), CV_64F, const_cast<double*>(levels.data())), smooth, {},
                   dot_smoothing_px);
  double const threshold = threshold_share * usual_height(smooth, noise);
  if (!(threshold > 0)) return found;
  Labels const regions = label_regions(smooth > threshold);
  std::vector<Shape> shapes;
  std::vector<int> label_of;
  std::vector<bool> is_dot(static_cast<std::size_t>(regions.count));
  for (int label = 1; label < regions.count; ++label) {
    cv::Rect const box = regions.box(label);
    bool const inside = box.x > 0 && box.y > 0 && box.br().x < levels.columns() && box.br().y < levels.rows();
    if (regions.area(label) < least_area || !inside) continue;
    shapes.push_back(shape_of(smooth, regions, label, threshold));
    label_of.push_back(label);
  }
  if (!shapes.empty()) {
    double const area = median_of(shapes, [](Shape const& shape) { return shape.area; });
    double const axes = median_of(shapes, [](Shape const& shape) { return shape.axes; });
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      bool const dot = looks_like(shapes[i], area, axes);
      is_dot[static_cast<std::size_t>(label_of[i])] = dot;
      if (dot) found.dots.push_back({shapes[i].centre, std::sqrt(shapes[i].area / CV_PI)});
      if (!dot) found.others.push_back(shapes[i].centre);
    }
  }
  choose_windows(found.dots);
  for (int row = 0; row < levels.rows(); ++row) {
    for (int column = 0; column < levels.columns(); ++column) {
      int const label = regions.labels.at<int>(row, column);
      if (label > 0 && !is_dot[static_cast<std::size_t>(label)]) found.not_dots(column, row) = 255;
    }
  }
  return found;
}

}  // namespace gladstone::inline calibration
