#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "studies/design/design_point.h"
#include "studies/design/question.h"

namespace gladstone {

/// Constraints on a set-up: first the user's requirements, then those for which the closed forms are valid.
enum class Bound {
  gradient_min,
  resolution,
  displacement_max,
  uncertainty_max,
  view_width,
  view_height,
  z_total,
  // Constraints of every set-up:
  focus,       ///< an image of the dots exists
  dots_clear,  ///< the dots are outside the medium
  lens_clear,  ///< the lens is outside the medium
  dot_least,   ///< the dot's geometric image is not below the range in which the random error was measured
  dot_most,    ///< the whole dot image is not above that range
  coverage,    ///< dots without overlap fit on the target
  noise_most,  ///< the noise is not above the range in which the random error was measured
  full_well,   ///< the peak is below full scale
};

/// Returns true for lower limits, for which a larger value is stricter.
inline bool from_below(Bound bound) { return bound == Bound::view_width || bound == Bound::view_height; }

/// A constraint with its limit, in SI.
struct Limit {
  Bound bound;
  double value;
};

/// Returns the name of a constraint for the user: the key of a requirement, a description for the others.
std::string bound_name(Bound bound);
/// Key of a requirement in the setup, whose suffix is the unit, and the value of that unit in SI.
struct BoundKey {
  char const* path;
  double unit;
};
BoundKey bound_key(Bound bound);

/// Returns the limits required by the user.
std::vector<Limit> required_limits(Requirements const& requirements);
/// Returns the limits that every set-up must meet.
std::vector<Limit> feasibility_limits(FixedDesignParameters const& given);

inline constexpr double closest_focus = 1.02;  ///< minimum distance of the dots from the lens, in focal lengths
/// maximum fraction of the target covered by dots; random discs without overlap reach 0.5
inline constexpr double most_coverage = 0.45;

/// Returns the excess of a set-up over a limit as the logarithm of a ratio; for the resolution, the deficit of transfer
/// at the required wavelength. A limit is met if the excess is 0 or less. If no image of the dots exists, returns the
/// excess over the limit `focus` instead.
/// @param bench  set-up; may contain derivatives
template <class T>
T excess(Limit const& limit, DesignPoint<T> const& bench) {
  using std::log;
  T const beyond_focus = bench.z_b() / bench.focal_length;
  if (beyond_focus < closest_focus || limit.bound == Bound::focus) return log(closest_focus / beyond_focus);
  FixedDesignParameters const& given = *bench.given;
  switch (limit.bound) {
    case Bound::gradient_min:
      return log(bench.smallest_gradient() / limit.value);
    case Bound::resolution:
      return transfer_at_resolution - bench.transfer(T(limit.value));
    case Bound::displacement_max:
      if (given.largest_gradient == 0) return T(-1);  // no displacement
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

/// Returns the quantity that an objective minimizes, in SI.
/// @param value  the same set-up without derivatives
template <class T>
T objective_value(Objective objective, DesignPoint<T> const& bench, DesignPoint<double> const& value) {
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

/// Optimization problem: objective and limits.
struct DesignProblem {
  Objective objective = Objective::gradient_min;
  std::vector<Limit> limits;
};

/// One combination of the discrete design variables, with the intervals of the continuous ones.
struct DesignBranch {
  FixedDesignParameters const* given = nullptr;
  std::array<double, choice_count> value{};  ///< value of every variable that is not continuous [SI]
  /// diameter of the geometric dot image, if given in px and not a design variable [px]
  std::optional<double> dot_px;
  std::vector<FreeChoice> continuous;  ///< continuous design variables with their intervals
  std::size_t variant = 0;             ///< index of the variant of camera and lens
};

/// Returns the set-up at a point of a branch, given the logarithms of its continuous design variables.
template <class T>
DesignPoint<T> design_point_at(DesignBranch const& branch, std::vector<T> const& logarithms) {
  using std::exp;
  std::array<T, choice_count> v;
  for (std::size_t i = 0; i < choice_count; ++i) v[i] = T(branch.value[i]);
  for (std::size_t i = 0; i < branch.continuous.size(); ++i) {
    v[static_cast<std::size_t>(branch.continuous[i].choice)] = exp(logarithms[i]);
  }
  DesignPoint<T> bench{branch.given, v[0], v[1], v[2], v[3], v[4]};
  if (branch.dot_px && bench.z_b() > bench.focal_length) bench.dot_diameter = *branch.dot_px * bench.pixel_at_dots();
  return bench;
}

}  // namespace gladstone
