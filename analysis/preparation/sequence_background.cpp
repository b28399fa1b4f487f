#include "analysis/preparation/sequence_background.h"

#include <algorithm>

#include "render/base/contracts.h"

namespace gladstone::inline preparation {
namespace {

using ReadImage = std::function<std::optional<Image<double>>(std::size_t k)>;

constexpr std::size_t most_median_bytes = std::size_t{256} << 20;  // maximum memory of compute_median() [bytes]

Image<double> compute_mean(std::size_t count, ReadImage const& read) {
  Image<double> sum;
  std::size_t used = 0;
  for (std::size_t k = 0; k < count; ++k) {
    std::optional<Image<double>> const image = read(k);
    if (!image) continue;
    if (used++ == 0) sum = Image<double>(image->columns(), image->rows(), 0.0);
    for (std::size_t i = 0; i < sum.size(); ++i) sum.data()[i] += image->data()[i];
  }
  for (double& level : sum) level /= static_cast<double>(used);
  return sum;
}

Image<double> compute_minimum(std::size_t count, ReadImage const& read) {
  Image<double> lowest;
  for (std::size_t k = 0; k < count; ++k) {
    std::optional<Image<double>> image = read(k);
    if (!image) continue;
    if (lowest.empty()) {
      lowest = std::move(*image);
      continue;
    }
    for (std::size_t i = 0; i < lowest.size(); ++i) lowest.data()[i] = std::min(lowest.data()[i], image->data()[i]);
  }
  return lowest;
}

/// Returns the median; reorders the values.
double median_level(std::vector<double>& values) {
  auto const middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

Image<double> compute_median(std::size_t count, ReadImage const& read) {
  Image<double> median;
  std::size_t band_pixels = 0;
  for (std::size_t first = 0; first == 0 || first < median.size(); first += band_pixels) {
    std::vector<std::vector<double>> levels;  // levels of a band of pixels, one array per image
    for (std::size_t k = 0; k < count; ++k) {
      std::optional<Image<double>> const image = read(k);
      if (!image) continue;
      if (median.empty()) {
        median = Image<double>(image->columns(), image->rows(), 0.0);
        band_pixels = std::max<std::size_t>(1, most_median_bytes / (count * sizeof(double)));
      }
      std::size_t const end = std::min(median.size(), first + band_pixels);
      levels.emplace_back(image->data() + first, image->data() + end);
    }
    if (levels.empty()) return median;
    std::vector<double> values(levels.size());
    for (std::size_t i = 0; i < levels.front().size(); ++i) {
      for (std::size_t k = 0; k < levels.size(); ++k) values[k] = levels[k][i];
      median.data()[first + i] = median_level(values);
    }
  }
  return median;
}

}  // namespace

std::vector<std::string> background_statistics() { return {"minimum", "mean", "median"}; }

Image<double> compute_background(std::string const& statistic, std::size_t count, ReadImage const& read) {
  if (statistic == "minimum") return compute_minimum(count, read);
  if (statistic == "mean") return compute_mean(count, read);
  GLADSTONE_EXPECTS(statistic == "median");
  return compute_median(count, read);
}

}  // namespace gladstone::inline preparation
