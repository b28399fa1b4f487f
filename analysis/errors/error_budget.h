#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/errors/error_summary.h"
#include "render/base/vec.h"

namespace gladstone {

/// One link of the chain of displacements, from Eq. 9 to the measurement, at the same N vectors [px].
struct BudgetStage {
  std::string name;                    ///< one of budget_stage_names()
  std::vector<Vec2d> displacement_px;  ///< empty: cannot be computed
};

/// Which chain of causes a budget follows.
enum class BudgetChain {
  bos,  ///< from Eq. 9
  piv,  ///< from the flow's displacement
};

/// The stages in the order of the chain. Of BOS:
/// eq9, straight (oblique chief ray, own lever per slice), eq9_cone, thin_lens (ray truth through the ideal lens at
/// the point), lens (ray truth through the actual lens), window (truth on the window), estimator (window plus mean
/// estimator error over K patterns; repeats only), noise_free (measurement on noise-free images), measured.
/// Of PIV: flow (the flow's velocity at the vector times dt, in the sheet, seen along the camera's local scale),
/// ambient (ray truth at the point without the medium), seen (ray truth with it), then window and all that follows.
std::vector<std::string_view> budget_stage_names(BudgetChain chain = BudgetChain::bos);

/// The terms in the same order: small_angle, cone, refraction, aberration, window, estimator, pattern, noise; of PIV
/// projection, refraction, window, estimator, pattern, noise.
std::vector<std::string_view> budget_term_names(BudgetChain chain = BudgetChain::bos);

/// The difference of consecutive stages over the vectors that count.
/// All numbers [px]; NaN (null in errors.json) where the term cannot be computed.
struct BudgetTerm {
  std::string name;
  /// Where a stage is absent, the difference across the gap is booked under the gap's first term and the others are
  /// NaN: the names of those others. (Foreign vectors without noise-free images: estimator includes pattern, noise.)
  std::vector<std::string> includes;
  double bias_u_px, bias_v_px;      ///< mean
  double random_u_px, random_v_px;  ///< standard deviation, of the population
  double rms_px;                    ///< sqrt(mean(t_u^2 + t_v^2)/2)
  bool known() const { return rms_px == rms_px; }
};

/// A square matrix [terms x terms], row by row.
struct CovarianceMatrix {
  std::size_t size = 0;
  std::vector<double> values;
  double operator()(std::size_t row, std::size_t column) const { return values[row * size + column]; }
};

/// The causes of the total departure of a measurement from Eq. 9; they add up exactly.
struct ErrorBudget {
  std::size_t count = 0;          ///< vectors
  std::vector<BudgetTerm> terms;  ///< in the order of budget_term_names()
  BudgetTerm total;               ///< last present stage minus first
  /// C_ij = mean((t_i - mean t_i)(t_j - mean t_j)) per component [px^2]; NaN in the rows of unknown terms.
  CovarianceMatrix covariance_u, covariance_v;
  /// (C_u + C_v)/2, so that its diagonal is the term's mean square fluctuation per component and the sum of all its
  /// entries is that of the total.
  CovarianceMatrix covariance;
  double closure_px = 0.0;       ///< largest |sum of terms - total| over vectors and components
  double peak_locking_px = 0.0;  ///< see peak_locking(); NaN without window truth or estimator
};

/// @param stages absent ones may be left out; the order is free; lengths equal mask.size()
/// @param mask   the common mask; vectors where a present stage is not finite are left out as well
/// @pre stage names are known and unique
ErrorBudget error_budget(std::span<BudgetStage const> stages, VectorMask const& mask,
                         BudgetChain chain = BudgetChain::bos);

/// Peak locking: the rms over the fractional part of the true displacement (20 bins of 0.05 px, both components
/// together, empty bins left out) of the mean error in the bin [px]. NaN of nothing.
double peak_locking(std::span<Vec2d const> truth_px, std::span<Vec2d const> error_px, VectorMask const& mask);

/// The `estimator` stage of a study with repeats: window truth of this pattern plus the mean over K patterns of
/// (noise-free measurement - window truth of that pattern); what is left to `noise_free` is the `pattern` term.
/// NaN patterns at a vector are left out of its mean.
BudgetStage mean_estimator_stage(std::span<Vec2d const> window_truth_px,
                                 std::span<std::vector<Vec2d> const> pattern_window_truth_px,
                                 std::span<std::vector<Vec2d> const> pattern_noise_free_px);

}  // namespace gladstone
