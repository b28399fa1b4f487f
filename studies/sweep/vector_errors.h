#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "studies/compare.h"

namespace gladstone {

/// One kind of error at single vectors of a case, kept so that repeats can be compared vector by vector.
struct VectorErrors {
  std::string name;              ///< of vector_error_names()
  std::vector<Vec2d> errors_px;  ///< at the same vectors in every repeat, to 1e-6 px; NaN where one does not count
};

/// "ray_truth", "eq9" (measurement less each) and "estimator" (noise-free measurement less truth on the window).
std::vector<std::string> const& vector_error_names();

/// Errors of vectors are kept as whole multiples of it [px].
inline constexpr double vector_unit_px = 1e-6;
/// Most vectors of a case whose errors are kept; of more, every second, third, ... row and column.
inline constexpr std::size_t most_kept_vectors = 1024;

/// These errors of a comparison, rounded to 1e-6 px.
std::vector<VectorErrors> vector_errors(Comparison const& comparison);

/// How an error divides over K repeats of one experiment, per component:
///   e_r(c) = what every repeat has at vector c + what changes with dots, rays and noise.
/// With the mean m(c) and the sample variance s^2(c) over repeats, scatter^2 = mean of s^2 and systematic^2 = mean of
/// m^2 - scatter^2 / K (0 at least), both without bias: systematic^2 + scatter^2 is the mean square of all errors.
struct RepeatSplit {
  std::size_t vectors = 0;  ///< that count in every repeat
  double systematic_px;     ///< rms of what is the same in every repeat; NaN with fewer than two
  double scatter_px;        ///< standard deviation between repeats; NaN with fewer than two
};
/// @param repeats of one kind of error; all of one length, or nothing is known
RepeatSplit split_repeats(std::span<std::vector<Vec2d> const> repeats);

/// Mean and sample standard deviation over repeats of the values that are finite; NaN of none, and of fewer than two.
struct MeanAndSpread {
  double mean, spread;
};
MeanAndSpread mean_and_spread(std::span<double const> values);

}  // namespace gladstone
