#pragma once

#include <vector>

#include "studies/compare/compare.h"
#include "studies/compare/reconstruct.h"

namespace gladstone::inline compare {

/// Splits the error of a reconstructed density into its causes. Reconstruction is linear in the displacement: the terms
/// of the displacement's budget (see error_budget()), reconstructed with the same reference, weights and axis, and the
/// error of the density reconstructed from Eq. 9 (`integration`: spacing of the vectors, reference density) add up to
/// the error. Only vectors that can be compared with the truth are used, so that the total may differ slightly from
/// compute_density_errors().
/// @param comparison      comparison of the same vectors, with the BOS chain of displacements
/// @param reconstruction  reconstruction from these vectors, with truth
/// @param window_px,options  as for reconstruct_density()
/// @return                terms in the order of the chain, then `total`
std::vector<DensityTerm> compute_density_budget(Comparison const& comparison, Reconstruction const& reconstruction,
                                                Setup const& setup, double window_px,
                                                ReconstructOptions const& options);

}  // namespace gladstone::inline compare
