#pragma once

#include <cstddef>

#include "render/sensor/pixel_detector.h"

/// Pixel-wise operations on light in device memory.
namespace gladstone::cuda::inline device {

/// Computes light[i] = white[i] - light[i].
void take_from_white(double const* white, double* light, std::size_t count);

/// Finds the maximum of `count` pixels as an ordered_key(), and stores it in `key` if it exceeds the stored value.
/// @param key  must be initialised to zero
void find_brightest(double const* light, std::size_t count, unsigned long long* key);
/// Converts a key of find_brightest() to the value of the brightest pixel, on the host.
double brightness_from_key(unsigned long long key);

/// Applies PixelDetector::record() to every pixel.
/// @param saturated  number of saturated pixels; must be initialised to zero
void record_levels(PixelDetector const& detector, RandomStream stream, double const* light, std::size_t count,
                   double* levels, unsigned long long* saturated);

/// Applies PixelDetector::ideal() to every pixel.
void ideal_levels(PixelDetector const& detector, double const* light, std::size_t count, double* levels);

}  // namespace gladstone::cuda::inline device
