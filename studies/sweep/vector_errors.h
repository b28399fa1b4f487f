#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "studies/compare/compare.h"

namespace gladstone::inline sweep {

/// Errors of one kind at individual vectors of a case, stored so that repeats can be compared vector by vector.
struct VectorErrors {
  std::string name;              ///< kind of the errors, one of vector_error_names()
  std::vector<Vec2d> errors_px;  ///< errors at the same vectors in every repeat, rounded to 1e-6 px; NaN at vectors
                                 ///< that are not compared
};

/// Returns the kinds of error: "ray_truth", "eq9" (measurement minus each), "estimator" (noise-free measurement minus
/// window truth).
std::vector<std::string> const& vector_error_names();

/// Resolution at which errors are stored [px].
inline constexpr double vector_unit_px = 1e-6;
/// Maximum number of stored vectors per case; of more, every n-th row and column is stored.
inline constexpr std::size_t most_kept_vectors = 1024;

/// Returns the errors of a comparison, rounded to vector_unit_px.
std::vector<VectorErrors> vector_errors(Comparison const& comparison);

/// Decomposition of an error over K repeats of an experiment into a systematic part, common to all repeats at a vector,
/// and scatter, which changes with dots, rays and noise. From the mean m and the sample variance s^2 over the repeats
/// at each vector, scatter^2 = mean of s^2 and systematic^2 = max(0, mean of m^2 - scatter^2 / K), averaged over
/// vectors and components. Both are unbiased; systematic^2 + scatter^2 estimates the mean square of a single repeat's
/// errors.
struct RepeatSplit {
  std::size_t vectors = 0;  ///< number of vectors with a known error in every repeat
  double systematic_px;     ///< rms of the common part, per component; NaN with fewer than two repeats
  double scatter_px;        ///< standard deviation between repeats, per component; NaN with fewer than two repeats
};
/// Computes the decomposition.
/// @param repeats  errors of one kind, one vector per repeat; if their lengths differ, the result is NaN
RepeatSplit split_repeats(std::span<std::vector<Vec2d> const> repeats);

/// Mean and sample standard deviation of the finite values over repeats. The mean is NaN without values, the
/// deviation with fewer than two.
struct MeanAndSpread {
  double mean, spread;
};
MeanAndSpread mean_and_spread(std::span<double const> values);

}  // namespace gladstone::inline sweep
