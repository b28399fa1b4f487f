#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/errors/error_summary.h"
#include "render/base/vec.h"

namespace gladstone::inline errors {

/// One stage of the displacement chain, from theory to measurement: displacements at N common vectors.
struct BudgetStage {
  std::string name;                    ///< one of budget_stage_names()
  std::vector<Vec2d> displacement_px;  ///< [N]; empty: not available
};

/// Chain of causes of a budget, which determines its stages and terms.
enum class BudgetChain {
  bos,  ///< starts from the small-angle theory (Eq. 9)
  piv,  ///< starts from the displacement of the flow
};

/// Returns the names of the stages in the order of the chain.
/// - BOS: eq9 (small-angle theory), straight (straight oblique chief ray; each slice of the medium has its own distance
///   to the dots), eq9_cone (aperture-averaged theory), thin_lens (ray truth at the point through an ideal lens), lens
///   (ray truth through the actual lens), window (truth averaged over the interrogation window), estimator (window plus
///   the mean estimator error over K patterns; only for repeats), noise_free (measurement on noise-free images),
///   measured.
/// - PIV: flow (velocity at the vector times dt, in the light sheet, mapped by the camera's local scale), ambient (ray
///   truth at the point without the medium), seen (ray truth with the medium), then window and all later stages as
///   above.
std::vector<std::string_view> budget_stage_names(BudgetChain chain = BudgetChain::bos);

/// Returns the names of the terms in the order of the chain. BOS chain: small_angle, cone, refraction, aberration,
/// window, estimator, pattern, noise. PIV chain: projection, refraction, window, estimator, pattern, noise.
std::vector<std::string_view> budget_term_names(BudgetChain chain = BudgetChain::bos);

/// Statistics of the difference between consecutive stages over the counted vectors [px]. NaN (null in errors.json) if
/// the term cannot be computed.
struct BudgetTerm {
  std::string name;
  /// Names of later terms that are included in this one. If stages are missing, the difference across the gap is
  /// assigned to the gap's first term and the other terms are NaN. (Vectors of external software without noise-free
  /// images: `estimator` includes `pattern` and `noise`.)
  std::vector<std::string> includes;
  double bias_u_px, bias_v_px;      ///< mean of the term
  double random_u_px, random_v_px;  ///< standard deviation of the term, normalised by N
  double rms_px;                    ///< sqrt(mean(t_u^2 + t_v^2)/2) of the term t
  bool known() const { return rms_px == rms_px; }
};

/// Square matrix [terms x terms], row-major.
struct CovarianceMatrix {
  std::size_t size = 0;
  std::vector<double> values;
  double operator()(std::size_t row, std::size_t column) const { return values[row * size + column]; }
};

/// Decomposition of the total difference between measurement and theory (or flow) into causes; the terms sum to the
/// total.
struct ErrorBudget {
  std::size_t count = 0;          ///< number of vectors over which the terms are averaged
  std::vector<BudgetTerm> terms;  ///< terms in the order of budget_term_names()
  BudgetTerm total;               ///< last available stage minus the first stage
  /// Covariance of the terms, C_ij = mean((t_i - mean t_i)(t_j - mean t_j)), for u and for v [px^2]; NaN in rows and
  /// columns of unknown terms.
  CovarianceMatrix covariance_u, covariance_v;
  /// Mean covariance (C_u + C_v)/2. A diagonal entry is the mean square fluctuation of the term per component; the sum
  /// of all entries is the mean square fluctuation of the total [px^2].
  CovarianceMatrix covariance;
  double closure_px = 0.0;       ///< largest |sum of terms - total| over vectors and components
  double peak_locking_px = 0.0;  ///< magnitude of peak_locking(); NaN without window truth or without a measurement
};

/// Computes the budget of a measurement.
/// @param stages stages in any order, with mask.size() displacements each; stages that are not available may be omitted
/// @param mask vectors to count; vectors at which an available stage is not finite are also excluded
/// @pre stage names are known and unique
ErrorBudget error_budget(std::span<BudgetStage const> stages, VectorMask const& mask,
                         BudgetChain chain = BudgetChain::bos);

/// Returns the magnitude of peak locking: the rms, over 20 bins of the fractional part of the true displacement (0.05
/// px each, both components pooled, empty bins skipped), of the mean error in the bin [px]. NaN if there are no vectors
/// with a finite truth and error.
double peak_locking(std::span<Vec2d const> truth_px, std::span<Vec2d const> error_px);

}  // namespace gladstone::inline errors
