#include "studies/case/image_statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/files/image_file.h"

namespace gladstone {
namespace {

/// Mean and mask response of the 3 x 3 neighbourhood of every inner pixel.
struct Neighbourhood {
  double mean;
  double response;
};

std::vector<Neighbourhood> neighbourhoods(Image<double> const& image) {
  std::vector<Neighbourhood> all;
  for (int row = 1; row + 1 < image.rows(); ++row) {
    for (int column = 1; column + 1 < image.columns(); ++column) {
      Neighbourhood here{};
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) {
          double const value = image(column + i, row + j);
          here.mean += value / 9;
          here.response += value * (i == 0 ? 2 : -1) * (j == 0 ? 2 : -1);
        }
      }
      if (std::isfinite(here.mean)) all.push_back(here);
    }
  }
  return all;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  auto const middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

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

}  // namespace

ImageStatistics image_statistics(Image<double> const& image) {
  double const unknown = std::nan("");
  ImageStatistics seen{0, unknown, unknown, unknown, unknown};
  auto const finite = static_cast<double>(image.size() - count_not_finite(image));
  for (double const value : image) seen.mean += std::isfinite(value) ? value / finite : 0;
  double skewness = 0;
  for (double const value : image) skewness += std::isfinite(value) ? std::pow(value - seen.mean, 3) : 0;
  double const sign = skewness < 0 ? -1 : 1;  // sign of the dots' contrast against the background

  std::vector<Neighbourhood> flat = neighbourhoods(image);
  if (!flat.empty()) {
    std::size_t const share = std::max<std::size_t>(1, flat.size() / 5);
    std::nth_element(flat.begin(), flat.begin() + static_cast<std::ptrdiff_t>(share - 1), flat.end(),
                     [&](Neighbourhood const& a, Neighbourhood const& b) { return sign * a.mean < sign * b.mean; });
    flat.resize(share);
    std::vector<double> levels;
    double variance = 0;
    for (Neighbourhood const& place : flat) {
      levels.push_back(place.mean);
      variance += place.response * place.response / static_cast<double>(share);
    }
    seen.background = median(levels);
    seen.noise = std::sqrt(variance) / 6;
    seen.dot_height = median(peak_heights(image, seen.background, sign));
  }
  seen.dot_diameter_px = dot_diameter_px(image, seen.mean, seen.noise);
  return seen;
}

}  // namespace gladstone
