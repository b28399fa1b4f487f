#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "studies/design/design_point.h"
#include "studies/design/question.h"

namespace ceres {
template <typename T, int N>
struct Jet;
}  // namespace ceres

namespace gladstone::inline design {

struct Estimate;
struct SimulatedDesign;

/// Number with its derivatives with respect to the design variables.
using DesignJet = ceres::Jet<double, static_cast<int>(choice_count)>;

/// Excess of a set-up over a limit [SI], as a function template with and without derivatives.
struct ExcessFunction {
  double (*value)(double limit, DesignPoint<double> const& bench);
  DesignJet (*derivatives)(double limit, DesignPoint<DesignJet> const& bench);

  template <class Function>
  constexpr ExcessFunction(Function function) : value(function), derivatives(function) {}
};

/// A constraint on a set-up: a requirement of the user, or one of those for which the closed forms are valid. A new one
/// requires one more row in bounds.cpp.
struct Bound {
  /// Set-up of a branch with the shortest (near) or the longest distances (far). If it violates the bound, so do all
  /// other set-ups of the branch. none: no set-up has this property.
  enum class Extreme { none, near, far };

  char const* name;  ///< path of a requirement's key, whose suffix is the unit; a description of the others
  double unit = 1;   ///< that unit in SI
  ExcessFunction excess;
  bool from_below = false;  ///< lower limit: a larger value is stricter
  Extreme extreme = Extreme::none;
  /// Prediction and simulation of the limited quantity, in SI; null: a simulation adds no information.
  std::pair<double, Estimate> (*simulated)(SimulatedDesign const&, DesignPoint<double> const&) = nullptr;
  /// Describes why a set-up does not meet the bound, given the excess; null: by how much it is too large or small.
  std::string (*violation)(double excess) = nullptr;
  /// Limit of every set-up; null: the user gives the limit.
  double (*given)(FixedDesignParameters const&) = nullptr;

  /// Return the parts of a requirement's path: table, key, and index in the array of the key, -1 for a number.
  std::string table() const;
  std::string key() const;
  int component() const;
};

/// Returns the possible requirements of a user, in the order of the output.
std::span<Bound const> requirements();
/// Returns the requirement of that name. @pre it exists
Bound const& requirement(std::string_view name);

extern Bound const in_focus;         ///< an image of the dots exists
extern Bound const below_full_well;  ///< the peaks are below full scale

/// Describes why a set-up exceeds a limit.
std::string describe_violation(Bound const& bound, double excess);

/// Returns the limits that every set-up must meet.
std::vector<Limit> feasibility_limits(FixedDesignParameters const& given);

inline constexpr double closest_focus = 1.02;  ///< minimum distance of the dots from the lens, in focal lengths

/// Returns the excess of a set-up over a limit as the logarithm of a ratio; for the resolution, the deficit of transfer
/// at the required wavelength. A limit is met if the excess is 0 or less. If no image of the dots exists, returns the
/// excess over the limit `in_focus` instead.
/// @param bench  set-up; T is double or DesignJet
template <class T>
T excess(Limit const& limit, DesignPoint<T> const& bench) {
  using std::log;
  T const beyond_focus = bench.z_b() / bench.focal_length;
  if (beyond_focus < closest_focus) return log(closest_focus / beyond_focus);
  if constexpr (std::is_same_v<T, double>) {
    return limit.bound->excess.value(limit.value, bench);
  } else {
    return limit.bound->excess.derivatives(limit.value, bench);
  }
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

}  // namespace gladstone::inline design
