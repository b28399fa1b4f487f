#pragma once

#include <complex>
#include <memory>

namespace gladstone {

/// A two-dimensional complex Fourier transform of one fixed square size, the piece of a correlator that libraries
/// differ in. A plan owns its scratch memory: use one per thread at a time.
class FourierPlan {
 public:
  virtual ~FourierPlan() = default;
  /// Values along one side of the square.
  virtual int size() const = 0;
  /// out(k) = sum over x of in(x) exp(-2 pi i k.x / size), row by row; `in` and `out` are different arrays of size^2.
  virtual void forward(std::complex<double> const* in, std::complex<double>* out) = 0;
  /// The same with the opposite sign in the exponent, without the division by size^2.
  virtual void inverse(std::complex<double> const* in, std::complex<double>* out) = 0;
};

/// OpenCV's transform (cv::hal::DFT2D: the tables of cv::dft, made once).
/// @param size any positive number; products of 2, 3 and 5 are fast
std::unique_ptr<FourierPlan> make_fourier_plan(int size);

}  // namespace gladstone
