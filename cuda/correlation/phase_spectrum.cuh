#pragma once

#include "cuda/correlation/small_transform.h"

namespace gladstone::cuda::inline correlation {

/// Phase of the cross spectrum, weighted by the spectrum of particle images. Eckstein & Vlachos (2009).
struct PhaseSpectrum {
  float const* particles;  ///< spectrum of particle images along one axis
  __device__ Complex operator()(Complex c, int kx, int ky) const {
    // The value at zero frequency is rounding error, since windows have zero mean.
    if (kx == 0 && ky == 0) return {0.0f, 0.0f};
    float const to = particles[kx] * particles[ky] / (sqrtf(c.re * c.re + c.im * c.im) + 1e-30f);
    return {to * c.re, to * c.im};
  }
};

}  // namespace gladstone::cuda::inline correlation
