#include "studies/case/image_statistics.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "render/base/median.h"
#include "render/files/image_file.h"

namespace gladstone::inline cases {
namespace {

/// Mean and mask response of the 3 x 3 neighbourhood of every inner pixel.
struct Neighbourhood {
  double mean;
  double response;
};

std::vector<Neighbourhood> neighbourhoods(Image<double> const& image) {
  std::vector<Neighbourhood> all;
  if (image.columns() < 3 || image.rows() < 3) return all;
  auto const columns = static_cast<std::size_t>(image.columns());
  all.reserve((columns - 2) * (static_cast<std::size_t>(image.rows()) - 2));
  std::vector<double> sum(columns), second(columns);  // sum over the three rows around `row`, and their response to [-1
                                                      // 2 -1], for each column
  for (int row = 1; row + 1 < image.rows(); ++row) {
    double const* const here = image.data() + static_cast<std::size_t>(row) * columns;
    for (std::size_t i = 0; i < columns; ++i) {
      double const rim = *(here + i - columns) + here[i + columns];
      sum[i] = here[i] + rim;
      second[i] = 2 * here[i] - rim;
    }
    for (std::size_t i = 1; i + 1 < columns; ++i) {
      Neighbourhood const found{(sum[i - 1] + sum[i] + sum[i + 1]) / 9, 2 * second[i] - second[i - 1] - second[i + 1]};
      if (std::isfinite(found.mean)) all.push_back(found);
    }
  }
  return all;
}

double median(std::vector<double> values) { return values.empty() ? std::nan("") : upper_median(std::move(values)); }

/// Returns the heights above the background of all local maxima that exceed a third of the largest height.
std::vector<double> peak_heights(Image<double> const& image, double background, double sign) {
  double largest = 0;
  for (double const value : image) {
    if (std::isfinite(value)) largest = std::max(largest, sign * (value - background));
  }
  std::vector<double> heights;
  for (int row = 1; row + 1 < image.rows(); ++row) {
    for (int column = 1; column + 1 < image.columns(); ++column) {
      double const height = sign * (image(column, row) - background);
      bool peak = height > largest / 3 && std::isfinite(height);
      for (int j = -1; j <= 1 && peak; ++j) {
        for (int i = -1; i <= 1 && peak; ++i) {
          peak = sign * (image(column + i, row + j) - background) <= height;
        }
      }
      if (peak) heights.push_back(height);
    }
  }
  return heights;
}

double dot_diameter_px(Image<double> const& image, double mean, double noise) {
  double zero = 0, one = 0;
  std::size_t pairs = 0;
  for (int row = 0; row < image.rows(); ++row) {
    for (int column = 0; column + 1 < image.columns(); ++column) {
      double const a = image(column, row) - mean, b = image(column + 1, row) - mean;
      if (!std::isfinite(a) || !std::isfinite(b)) continue;
      zero += 0.5 * (a * a + b * b);
      one += a * b;
      ++pairs;
    }
  }
  if (std::isfinite(noise)) zero -= noise * noise * static_cast<double>(pairs);
  double const ratio = zero > 0 ? one / zero : 0;
  return ratio > 0 && ratio < 1 ? std::sqrt(-4 / std::log(ratio)) : std::nan("");
}

double mean_level(Image<double> const& image) {
  auto const finite = static_cast<double>(image.size() - count_not_finite(image));
  double sum = 0;
  for (double const value : image) sum += std::isfinite(value) ? value : 0;
  return sum / finite;
}

/// Returns 1 if the dots are brighter than their background, -1 if they are darker.
double contrast_sign(Image<double> const& image, double mean) {
  double skewness = 0;
  for (double const value : image) {
    double const deviation = value - mean;
    skewness += std::isfinite(value) ? deviation * deviation * deviation : 0;
  }
  return skewness < 0 ? -1 : 1;
}

/// Selects the neighbourhoods whose mean is farthest from the dots' level.
std::vector<Neighbourhood> flat_neighbourhoods(Image<double> const& image, double sign) {
  std::vector<Neighbourhood> flat = neighbourhoods(image);
  if (flat.empty()) return flat;
  std::size_t const share = std::max<std::size_t>(1, flat.size() / 5);
  std::nth_element(flat.begin(), flat.begin() + static_cast<std::ptrdiff_t>(share - 1), flat.end(),
                   [&](Neighbourhood const& a, Neighbourhood const& b) { return sign * a.mean < sign * b.mean; });
  flat.resize(share);
  return flat;
}

/// Returns the standard deviation of a pixel's noise; NaN without neighbourhoods.
double noise_level(std::vector<Neighbourhood> const& flat) {
  double sum = 0;
  for (Neighbourhood const& place : flat) sum += place.response * place.response;
  return std::sqrt(sum / static_cast<double>(flat.size())) / 6;
}

}  // namespace

ImageStatistics image_statistics(Image<double> const& image) {
  double const unknown = std::nan("");
  ImageStatistics seen{mean_level(image), unknown, unknown, unknown, unknown};
  double const sign = contrast_sign(image, seen.mean);
  std::vector<Neighbourhood> const flat = flat_neighbourhoods(image, sign);
  if (!flat.empty()) {
    std::vector<double> levels;
    for (Neighbourhood const& place : flat) levels.push_back(place.mean);
    seen.background = median(levels);
    seen.noise = noise_level(flat);
    seen.dot_height = median(peak_heights(image, seen.background, sign));
  }
  seen.dot_diameter_px = dot_diameter_px(image, seen.mean, seen.noise);
  return seen;
}

double measure_dot_diameter_px(Image<double> const& image) {
  double const mean = mean_level(image);
  return dot_diameter_px(image, mean, noise_level(flat_neighbourhoods(image, contrast_sign(image, mean))));
}

}  // namespace gladstone::inline cases
