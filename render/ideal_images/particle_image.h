#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/vec.h"
#include "render/scene/ideal_projection.h"

namespace gladstone::inline ideal_images {

/// Particle's image in one frame: a Gaussian.
struct ParticleImage {
  Vec2d at;          ///< position on the sensor [px]
  double light = 0;  ///< photons, or light in units of photon_unit(); 0: no image
  double sigma = 1;  ///< standard deviation [px]
};

/// Blur of points at distance Z - z from an ideal thin lens that is focused on the distance Z.
///
/// The image of a point without diffraction is a uniform disc about its pinhole projection, of radius r = M D |z| / (2
/// (Z - z)) (exact; Olsen & Adrian 2000). Its convolution with a Gaussian PSF is approximated by a Gaussian of variance
/// sigma^2 + r^2/4, the sum of the variances along an axis. The error is largest in the centre. With t = r^2 / (2
/// sigma^2) and relative to the PSF, the centre of the image is (1 - exp(-t)) / t = 1 - t/2 + t^2/6 - ..., and that of
/// the approximation is 1 / (1 + t/2) = 1 - t/2 + t^2/4 - ...: too bright by less than t^2/12 = (r / (2 sigma))^4 / 3.
/// If the light changes over the stop by a fraction g from its centre to its edge, the image by rays is displaced by r
/// g / 4 from the projection, in both frames. This is neglected.
struct DefocusBlur {
  double sigma = 1;   ///< standard deviation of the PSF [px]
  double lens_z = 1;  ///< distance Z from the lens to the plane in focus [m]
  double reach = 0;   ///< M D / 2, magnification times radius of the pupil [px]; 0: the blur is neglected

  /// Returns the radius of the circle of confusion of a point [px]. @param z  its position on the axis [m]
  GLADSTONE_HD double radius(double z) const {
    using std::abs;
    return reach * abs(z) / (lens_z - z);
  }
  /// Returns the standard deviation of the image of a point [px].
  GLADSTONE_HD double width(double z) const {
    using std::sqrt;
    double const r = radius(z);
    return r > 0 ? sqrt(sigma * sigma + 0.25 * r * r) : sigma;
  }
  /// Returns the upper limit of the error of the image of a point, relative to the centre of the PSF [1].
  GLADSTONE_HD double error(double z) const {
    double const t = radius(z) / (2 * sigma);
    return t * t * t * t / 3;
  }
};

/// Blur error, relative to the centre of the brightest image, up to which images are as accurate as ray-traced ones:
/// half a grey level of 12 bits.
inline constexpr double accurate_blur_error = 0.5 / 4095;
/// Light, relative to the brightest image, below which the margins of blurred images may be cut off.
inline constexpr double faint_image = 1e-4;

}  // namespace gladstone::inline ideal_images
