#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace gladstone::inline density {

/// Size of the interrogation windows relative to the distance between vectors, along x and y [1]: 1 / (1 - overlap).
/// Values up to 1 mean vectors with independent errors. For weighted windows, use the effective window size: the size
/// of the uniform window with the same noise.
struct WindowOverlap {
  double x = 1.0;
  double y = 1.0;
  /// Overlap as a fraction of the window size, 0 to below 1, equal along both axes.
  static WindowOverlap from_fraction(double overlap);
};

/// Checks that the size of the windows along each axis is positive, finite, and at most that of the grid.
/// @throws SetupError if the size is out of this range
void check_window_overlap(int columns, int rows, WindowOverlap overlap);

/// Correlation of the errors of vectors whose interrogation windows overlap. Errors that are linear in the noise of the
///   pixels correlate in proportion to the area that the two windows share. For uniform windows of m grid steps, the
///   correlation is r(i, j) = max(0, 1 - |i| / m_x) max(0, 1 - |j| / m_y) for vectors i columns and j rows apart (cf.
///   Sciacchitano & Wieneke, Meas. Sci. Technol. 27 (2016) 084006). The two components of a vector are uncorrelated.
///   The matrix of all correlations is the Kronecker product of two banded matrices, whose Cholesky factors are stored.
class WindowCorrelation {
 public:
  /// @throws SetupError  see check_window_overlap()
  WindowCorrelation(int columns, int rows, WindowOverlap overlap);

  /// Converts independent values z of unit variance to correlated ones, L z, with the Cholesky factor L of r; the
  /// covariance of the result is r.
  /// @param values  one value per node, row by row [rows columns]
  std::vector<double> correlate(std::span<double const> values) const;
  /// Applies the transposed Cholesky factor and returns L^T z, whose squared length is z^T r z.
  std::vector<double> correlate_transposed(std::span<double const> values) const;

 private:
  /// Banded Cholesky factor of one axis; row i has the elements of columns i - band to i.
  struct Factor {
    int size = 0, band = 0;
    std::vector<double> element;
    double operator()(int i, int j) const { return element[static_cast<std::size_t>(i) * (band + 1) + (j - i + band)]; }
  };
  static Factor factorize(int size, double window);
  /// Multiplies by the Cholesky factor L, or by L^T if `transposed`.
  template <bool transposed>
  std::vector<double> multiply(std::span<double const> values) const;
  int columns_, rows_;
  Factor along_x_, along_y_;
};

}  // namespace gladstone::inline density
