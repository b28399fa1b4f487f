#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "studies/design/bench.h"
#include "studies/design/question.h"

namespace gladstone {

/// What a bench can break: first what the user requires, then what a bench must keep to be one that the formulas
/// describe.
enum class Bound {
  gradient_min,
  resolution,
  displacement_max,
  uncertainty_max,
  view_width,
  view_height,
  z_total,
  // of every bench
  focus,       ///< an image of the dots exists
  dots_clear,  ///< of the medium
  lens_clear,  ///< of the medium
  dot_least,   ///< the dot's geometric image is as large as the smallest that the random error was measured at
  dot_most,    ///< and the whole image no larger than the largest
  coverage,    ///< dots without overlap have room
  noise_most,  ///< the noise is no more than the random error was measured at
  full_well,   ///< the peak stays below full scale
};

constexpr bool required_by_user(Bound bound) { return bound < Bound::focus; }

/// A bound with its limit, in SI.
struct Limit {
  Bound bound;
  double value;
};

/// What a bound is called: the key for the user's, words for the others.
std::string bound_name(Bound bound);
/// Key of a requirement, its unit as suffix, and that unit in SI.
struct BoundKey {
  char const* path;
  double unit;
};
BoundKey bound_key(Bound bound);

/// The user's limits, as far as they are given.
std::vector<Limit> required_limits(Requirements const& requirements);
/// Those of every bench.
std::vector<Limit> bench_limits(BenchGiven const& given);

inline constexpr double closest_focus = 1.02;  ///< least distance of the dots from the lens, in focal lengths
inline constexpr double most_coverage = 0.45;  ///< of the target by dots; random discs without overlap reach 0.5

/// By how much a bench exceeds a limit, as the logarithm of the ratio (the resolution as the transfer that lacks at the
/// wavelength required): 0 or less is kept. Where no image of the dots exists, what lacks to its existence.
/// @param bench may carry derivatives
template <class T>
T excess(Limit const& limit, Bench<T> const& bench) {
  using std::log;
  T const beyond_focus = bench.z_b() / bench.focal_length;
  if (beyond_focus < closest_focus || limit.bound == Bound::focus) return log(closest_focus / beyond_focus);
  BenchGiven const& given = *bench.given;
  switch (limit.bound) {
    case Bound::gradient_min:
      return log(bench.smallest_gradient() / limit.value);
    case Bound::resolution:
      return transfer_at_resolution - bench.transfer(T(limit.value));
    case Bound::displacement_max:
      if (given.largest_gradient == 0) return T(-1);  // nothing moves
      return log(bench.largest_displacement_px() / limit.value);
    case Bound::uncertainty_max:
      return log(bench.random_error() / limit.value);
    case Bound::view_width:
      return log(limit.value / (double(given.camera.columns) * bench.pixel_at_medium()));
    case Bound::view_height:
      return log(limit.value / (double(given.camera.rows) * bench.pixel_at_medium()));
    case Bound::z_total:
      return log(bench.z_b() / limit.value);
    case Bound::focus:
      break;
    case Bound::dots_clear:
      return log(limit.value / bench.z_d);
    case Bound::lens_clear:
      return log(limit.value / bench.z_a);
    case Bound::dot_least:
      return log(limit.value / bench.geometric_dot_px());
    case Bound::dot_most:
      return log(bench.dot_image_px() / limit.value);
    case Bound::coverage:
      return log(bench.coverage() / limit.value);
    case Bound::noise_most:
      return log(bench.noise() / limit.value);
    case Bound::full_well:
      return log(bench.peak_electrons() / limit.value);
  }
  return T(0);
}

/// The quantity that an objective makes small, in SI. @param value the same bench without derivatives
template <class T>
T objective_value(Objective objective, Bench<T> const& bench, Bench<double> const& value) {
  switch (objective) {
    case Objective::gradient_min:
      return bench.smallest_gradient();
    case Objective::resolution:
      if constexpr (std::is_same_v<T, double>) {
        return resolved_wavelength(value);
      } else {
        return resolved_wavelength(bench, value);
      }
    case Objective::uncertainty:
      return bench.random_error();
    case Objective::z_total:
      break;
  }
  return bench.z_b();
}

/// What is to be solved: an objective, and limits.
struct DesignProblem {
  Objective objective = Objective::gradient_min;
  std::vector<Limit> limits;
};

/// One combination of what is chosen from lists, and the intervals of what is not.
struct DesignBranch {
  BenchGiven const* given = nullptr;
  std::array<double, choice_count> value{};  ///< of every choice that is not continuous [SI]
  std::optional<double> dot_px;              ///< geometric image of a dot whose size is told in px and not chosen
  std::vector<FreeChoice> continuous;        ///< intervals
  std::size_t variant = 0;                   ///< camera and lens: a number of the caller's
};

/// The bench at a point of a branch, given by the logarithms of its continuous choices.
template <class T>
Bench<T> bench_at(DesignBranch const& branch, std::vector<T> const& logarithms) {
  using std::exp;
  std::array<T, choice_count> v;
  for (std::size_t i = 0; i < choice_count; ++i) v[i] = T(branch.value[i]);
  for (std::size_t i = 0; i < branch.continuous.size(); ++i) {
    v[static_cast<std::size_t>(branch.continuous[i].choice)] = exp(logarithms[i]);
  }
  Bench<T> bench{branch.given, v[0], v[1], v[2], v[3], v[4]};
  if (branch.dot_px && bench.z_b() > bench.focal_length) bench.dot_diameter = *branch.dot_px * bench.pixel_at_dots();
  return bench;
}

}  // namespace gladstone
