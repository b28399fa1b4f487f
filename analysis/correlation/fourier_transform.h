#pragma once

#include <complex>
#include <vector>

namespace gladstone::inline correlation {

enum class FourierDirection { forward, inverse };

/// Computes out(k) = sum over x of in(x) exp(-+2 pi i k.x / size), row by row in double precision, by OpenCV's
/// transform. The inverse transform has the opposite sign in the exponent and is not divided by size^2.
/// @param in,  out  different arrays of size^2 values
/// @param size     any positive number; the transform is fast if it is a product of 2, 3 and 5
void fourier_transform(std::vector<std::complex<double>> const& in, std::vector<std::complex<double>>& out, int size,
                       FourierDirection direction);

}  // namespace gladstone::inline correlation
