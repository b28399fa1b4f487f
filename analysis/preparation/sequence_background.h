#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "render/base/image.h"

/// Background images that are computed from many frames.
namespace gladstone::inline preparation {

/// Background of a sequence's own frames. A "background" step without `frame` subtracts it from every pair; its images
/// must be computed before the first pair is prepared.
struct SequenceBackground {
  std::string statistic;    ///< "minimum", "mean" or "median"
  Image<double> reference;  ///< background image subtracted from each frame A
  Image<double> flow;       ///< background image subtracted from each frame B
};

/// Names accepted as the statistic of a background.
std::vector<std::string> background_statistics();

/// Computes the minimum, mean or median of images, pixel by pixel. The mean and the minimum hold one image in memory;
/// the median reads all images once per band of pixels, so that it holds at most 256 MiB. The median of an even number
/// of values is the mean of the middle two.
/// @param statistic  one of background_statistics()
/// @param read       returns image k, or nullopt to exclude it; all images have one size
/// @return an empty image if all images are excluded
Image<double> compute_background(std::string const& statistic, std::size_t count,
                                 std::function<std::optional<Image<double>>(std::size_t k)> const& read);

}  // namespace gladstone::inline preparation
