#pragma once

#include <string>

#include "studies/case/backend.h"
#include "studies/case/case.h"
#include "studies/compare/compare.h"
#include "studies/compare/reconstruct.h"

namespace gladstone::inline compare {

/// Reconstructs density from the vectors of a CASE, or of a setup whose images were measured, and for a rendered CASE
/// adds the true density and, with options.budget, the causes of the error, for which it compares the vectors with
/// truth and theory (compare_case()). Writes nothing.
/// @param place       case folder, with or without truth.h5, or a setup (TOML) together with options.vectors
/// @param device      device of the comparison
/// @param setup       setup of the case, if the caller has read it; null: reads it
/// @param comparison  comparison of the same vectors, if the caller has computed it; null: compares if required
/// @throws DataError, SetupError  as reconstruct_density(), and for files that are missing, invalid, or of other frames
Reconstruction reconstruct_case(std::string const& place, ReconstructOptions const& options, Backend const& device,
                                CaseSetup const* setup = nullptr, Comparison const* comparison = nullptr);

}  // namespace gladstone::inline compare
