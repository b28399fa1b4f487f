#pragma once

#include "render/base/image_samples.h"

namespace gladstone::cuda::inline device {

/// Converts an image in device memory to grey levels row by row, on the default stream.
/// @param not_finite  number of samples that are NaN or infinite; must be initialised to zero
void copy_samples(ImageSamples const& image, double* levels, unsigned long long* not_finite);

}  // namespace gladstone::cuda::inline device
