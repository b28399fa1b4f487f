#pragma once

#include <string>

#include "studies/design/sheet.h"

namespace gladstone::inline design {

/// Returns the gradient for the sheet's displacements: the largest in view, or 10 kg/m^4 if there is none [kg/m^4].
double sheet_gradient(FixedDesignParameters const& given);

/// Returns how a set-up exceeds the range of the study to which the random error (F26) was fitted, e.g. "dots below 0.8
/// px, ..."; empty: within.
std::string beyond_study(DesignPoint<double> const& bench);

/// Computes the sheet of a BOS set-up, F1 to F27. If no gradient is given, deflections are for 10 kg/m^4.
DesignSheet bos_sheet(Setup const& setup, DesignPoint<double> const& bench);

}  // namespace gladstone::inline design
