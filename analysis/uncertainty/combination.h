#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/vec.h"

/// One uncertainty from several: what they tell together, learnt where errors are known.
namespace gladstone {

/// ln sigma = constant + sum over methods of weight times ln sigma of the method [px]. Rajendran, Bhattacharya, Bane &
/// Vlachos, Meas. Sci. Technol. 32 (2021) 104002, combine methods by weights too, which they find anew in every window
/// by perturbing its images; ours are learnt once from errors that are known, and the sum is of logarithms, so that
/// sigma stays positive and a scale that is wrong by a factor does no harm.
struct UncertaintyCombination {
  double constant = 0.0;
  struct Term {
    std::string method;
    double weight;
  };
  std::vector<Term> terms;

  /// A term that is not finite is left out, and the others' weights grow by one factor until their sum is what it was:
  /// a sigma that all methods scale alike then still scales so. NaN where the weights that are left add up to nothing.
  /// @param log_sigma of the terms, in their order
  double log_sigma(std::span<double const> log_sigma) const;
};

/// Reads "term,coefficient" lines, the first of them the header, "constant" among the terms.
/// @pre every line is of that form
UncertaintyCombination parse_combination(std::string_view text);

/// The combination that data/uncertainty/combination.csv holds, built into the program.
UncertaintyCombination const& shipped_combination();

/// What a combination is learnt from: a component of a vector.
struct UncertaintySample {
  std::vector<double> log_sigma;  ///< by every method that is combined
  double error_px;
};

/// The constant and weights under which the errors are likeliest, if they are normal with the combined sigma: the
/// minimum of sum ln sigma + e^2/(2 sigma^2), which is convex in them, by Newton's method.
/// @pre more samples than methods, some error is not zero
UncertaintyCombination fit_combination(std::span<UncertaintySample const> samples,
                                       std::vector<std::string> const& methods);

/// "term,coefficient" lines that parse_combination() reads.
std::string combination_text(UncertaintyCombination const& combination);

}  // namespace gladstone
