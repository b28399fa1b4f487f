#pragma once

#include <string>

#include "studies/case/backend.h"
#include "studies/case/case.h"
#include "studies/compare/compare.h"
#include "studies/compare/reconstruct.h"

namespace gladstone::inline compare {

/// Parts of a measurement that the caller has read or computed before reconstruct_case(); null: it does so itself.
struct KnownMeasurement {
  CaseSetup const* setup = nullptr;
  Comparison const* comparison = nullptr;  ///< comparison of the same vectors
};

/// Reconstructs density from the vectors of a CASE, or of a setup whose images were measured, and for a rendered CASE
/// adds the true density and, with options.budget, the causes of the error, for which it compares the vectors with
/// truth and theory (compare_case()). Writes nothing.
/// @param place   case folder, with or without truth.h5, or a setup (TOML) together with options.vectors
/// @param device  device of the comparison
/// @throws DataError, SetupError  as reconstruct_density(), and for files that are missing, invalid, or of other frames
Reconstruction reconstruct_case(std::string const& place, ReconstructOptions const& options, Backend const& device,
                                KnownMeasurement known = {});

}  // namespace gladstone::inline compare
