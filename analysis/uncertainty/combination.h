#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/vec.h"

/// Combination of several uncertainty estimates into one, calibrated with known errors.
namespace gladstone::inline uncertainty {

/// Log-linear combination of uncertainty estimates: ln sigma = constant + sum over all methods of weight times ln sigma
/// of the method, sigma in px. Rajendran, Bhattacharya, Bane & Vlachos, Meas. Sci. Technol. 32 (2021) 104002, also use
/// a weighted combination, but determine the weights for every window by perturbing its images. Here they are fitted
/// once to known errors, and logarithms are summed, so that sigma is positive and a method's constant scale error is
/// compensated.
struct UncertaintyCombination {
  double constant = 0.0;
  struct Term {
    std::string method;
    double weight;
  };
  std::vector<Term> terms;

  /// Returns the combined ln sigma. Terms that are not finite are omitted, and the remaining weights are multiplied by
  /// a common factor that restores their sum; a factor common to the sigma of all methods therefore changes the result
  /// as if no term were omitted. NaN if the sum of the remaining weights is not positive.
  /// @param log_sigma  ln sigma of each method, in the order of the combination's terms
  double log_sigma(std::span<double const> log_sigma) const;
};

/// Parses lines of the form "term,coefficient" after a header line; the term "constant" is the constant.
/// @pre every line has this form
UncertaintyCombination parse_combination(std::string_view text);

/// Returns the combination of data/uncertainty/combination.csv, which is compiled into the program.
UncertaintyCombination const& shipped_combination();

/// Training sample of the combination: one component of a vector.
struct UncertaintySample {
  std::vector<double> log_sigma;  ///< ln sigma by every method [px]
  double error_px;
};

/// Fits the constant and the weights by maximum likelihood, assuming that each error e is normally distributed with the
/// combined sigma. Minimises the sum of ln sigma + e^2/(2 sigma^2), which is convex in the coefficients, by Newton's
/// method.
/// @pre more samples than methods; at least one error is not zero
UncertaintyCombination fit_combination(std::span<UncertaintySample const> samples,
                                       std::vector<std::string> const& methods);

/// Returns a header and "term,coefficient" lines in the format of parse_combination().
std::string combination_text(UncertaintyCombination const& combination);

}  // namespace gladstone::inline uncertainty
