#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/case/backend.h"
#include "studies/design/recommend.h"
#include "studies/design/simulation.h"

namespace gladstone::inline design {

/// A quantity predicted by formula and measured in simulation.
struct VerifiedQuantity {
  std::string key;             ///< name with the unit as suffix
  double predicted = 0;        ///< predicted value in the key's unit, like predicted_error and simulated
  double predicted_error = 0;  ///< standard error of the formula
  Estimate simulated;
  bool rms = false;  ///< true: the quantity is a root mean square, and the error of its square is normally distributed
  std::string why;   ///< explanation of a disagreement

  /// Returns true if the difference is within two combined standard errors.
  bool agrees() const;
};

/// A requirement checked in simulation, in SI.
struct VerifiedRequirement {
  Bound const* bound;
  double required = 0;
  double predicted = 0;
  Estimate simulated;

  /// Returns true if the simulation meets the requirement within two standard errors.
  bool kept() const;
};

/// A recommended design that was simulated.
struct VerifiedDesign {
  BranchOutcome outcome;
  std::string name;
  SimulatedDesign simulated;
  std::vector<VerifiedQuantity> quantities;       ///< empty if the simulation failed
  std::vector<VerifiedRequirement> requirements;  ///< requirements that a simulation can check
  /// true: solved with stricter limits, because earlier designs missed the required ones in simulation
  bool tightened = false;

  /// Returns true if the simulation succeeded and all requirements are met.
  bool kept() const;
};

/// Result of simulating a recommendation.
struct Verification {
  std::vector<VerifiedDesign> benches;  ///< designs in the order in which they were simulated
  std::optional<std::size_t> chosen;    ///< first design that meets the requirements

  /// Returns true if any simulation succeeded.
  bool any() const;
};

/// Extent of a verification.
struct VerificationPlan {
  std::size_t benches = 3;        ///< number of feasible combinations to simulate, starting with the best
  std::size_t repeats = 2;        ///< number of repeats per medium and design
  std::uint64_t seed = 20260101;  ///< base seed of dots, rays and noise; replaces the setup's seeds
};

inline constexpr int most_tightened = 2;  ///< maximum number of times that limits are tightened

/// Compares predicted and simulated quantities of a design.
void compare_with_formulas(VerifiedDesign& verified, std::vector<Limit> const& required);

/// Simulates the best feasible combinations. If no design meets the requirements, tightens the limits missed by the
/// best one by the ratio of simulation to formula, solves again, and simulates the new best design.
/// @pre answer.feasible()
Verification verify(DesignQuestion const& question, std::vector<DesignVariant> const& variants,
                    std::vector<DesignBranch> const& branches, Recommendation const& answer,
                    VerificationPlan const& plan, Backend device);

}  // namespace gladstone::inline design
