#pragma once

#include <complex>
#include <memory>

namespace gladstone {

/// Two-dimensional complex Fourier transform of a fixed square size. A plan owns its scratch memory: it must not be
/// used by several threads at a time.
class FourierPlan {
 public:
  virtual ~FourierPlan() = default;
  /// Number of values along one side of the square.
  virtual int size() const = 0;
  /// Computes out(k) = sum over x of in(x) exp(-2 pi i k.x / size), row by row; `in` and `out` are different arrays of
  /// size^2.
  virtual void forward(std::complex<double> const* in, std::complex<double>* out) = 0;
  /// Like forward() with the opposite sign in the exponent; the result is not divided by size^2.
  virtual void inverse(std::complex<double> const* in, std::complex<double>* out) = 0;
};

/// Creates a plan of OpenCV's transform (cv::hal::DFT2D, whose tables are computed once).
/// @param size  any positive number; products of 2, 3 and 5 are fast
std::unique_ptr<FourierPlan> make_fourier_plan(int size);

}  // namespace gladstone
