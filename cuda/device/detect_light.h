#pragma once

#include <cstddef>

#include "render/sensor/pixel_detector.h"

/// Per-pixel work on light that is on the device.
namespace gladstone::cuda {

/// light[i] = white[i] - light[i]
void take_from_white(double const* white, double* light, std::size_t count);

/// The brightest of `count` pixels as an ordered key, joined with what `key` holds. @param key zero to begin with
void find_brightest(double const* light, std::size_t count, unsigned long long* key);
/// The value of such a key, on the host.
double brightest_of(unsigned long long key);

/// As PixelDetector::record. @param saturated counts pixels, zero to begin with
void record_levels(PixelDetector const& detector, RandomStream stream, double const* light, std::size_t count,
                   double* levels, unsigned long long* saturated);

/// As PixelDetector::ideal.
void ideal_levels(PixelDetector const& detector, double const* light, std::size_t count, double* levels);

}  // namespace gladstone::cuda
