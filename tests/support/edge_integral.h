#pragma once

#include "render/sensor/diffraction_spot.h"

namespace gladstone {

/// Returns the integral of a PSF from its centre to edge `edge` of a footprint that begins at pixel `first`, with the
/// same operations as GaussianSpot::shares(): the share of pixel first + i is edge_integral(i + 1) - edge_integral(i).
template <class T>
T edge_integral(GaussianSpot<T> const& spot, T p, int first, int edge) {
  int const within = edge % 8;
  return GaussianSpot<T>::edge_value((T(first + (edge - within)) - p + (T(within) - T(0.5))) * (T(1) / spot.sigma));
}

}  // namespace gladstone
