#pragma once

#include <vector>

#include "render/base/image.h"
#include "render/ideal_images/particle_image.h"
#include "render/sensor/diffraction_spot.h"

namespace gladstone::inline ideal_images {

/// Draws particle images on the CPU: each is a PSF times its light. A pixel adds up its contributions in the order of
/// the images, so that the result is bitwise identical for any number of threads.
Image<double> draw_light(std::vector<ParticleImage> const& images, GaussianSpot<double> const& shape, int columns,
                         int rows);

}  // namespace gladstone::inline ideal_images
