#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/design/recommend.h"
#include "studies/design/simulation.h"
#include "studies/device.h"

namespace gladstone {

/// A quantity as the formulas predict it and as the simulation has it.
struct VerifiedQuantity {
  std::string key;             ///< with its unit as suffix
  double predicted = 0;        ///< in the key's unit, as the two that follow
  double predicted_error = 0;  ///< standard error of the formula
  Estimate simulated;
  bool rms = false;  ///< a root mean square, of which the square has the errors of a normal distribution
  std::string why;   ///< of a disagreement

  /// Within two standard errors of both together.
  bool agrees() const;
};

/// A requirement as the simulation keeps it. In SI.
struct VerifiedRequirement {
  Bound bound;
  double required = 0;
  double predicted = 0;
  Estimate simulated;

  /// Within two standard errors.
  bool kept() const;
};

/// A recommended bench that was simulated.
struct VerifiedBench {
  BranchOutcome outcome;
  std::string name;
  SimulatedBench simulated;
  std::vector<VerifiedQuantity> quantities;       ///< empty where the simulation failed
  std::vector<VerifiedRequirement> requirements;  ///< those that a simulation can tell
  bool tightened = false;  ///< solved for stricter limits, since what was solved for those required did not keep them

  bool kept() const;
};

/// What rendering and correlating says of a recommendation.
struct Verification {
  std::vector<VerifiedBench> benches;  ///< in the order in which they were simulated
  std::optional<std::size_t> chosen;   ///< the first that keeps what is required

  /// Whether any could be simulated at all.
  bool any() const;
};

/// What is to be simulated.
struct VerificationPlan {
  std::size_t benches = 3;        ///< of the feasible combinations, the best first
  std::size_t repeats = 2;        ///< of every medium of each
  std::uint64_t seed = 20260101;  ///< of dots, rays and noise; a setup's own seeds are not used
};

inline constexpr int most_tightened = 2;  ///< times that limits are made stricter for the simulation to keep them

/// Compares what a bench was predicted to do with what its simulation came to.
void compare_with_formulas(VerifiedBench& verified, std::vector<Limit> const& required);

/// Renders and correlates the best few of the feasible combinations. Where none keeps what is required, the limits that
/// the best one misses are made stricter by as much as the simulation is worse than the formula, and what is best then
/// is simulated.
/// @pre answer.feasible()
Verification verify(DesignQuestion const& question, std::vector<DesignVariant> const& variants,
                    std::vector<DesignBranch> const& branches, Recommendation const& answer,
                    VerificationPlan const& plan, Device device);

}  // namespace gladstone
