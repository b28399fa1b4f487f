#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/design/design_point.h"
#include "studies/design/question.h"
#include "studies/design/recommend.h"

namespace gladstone {

/// Resolution against sensitivity as a function of Z_D for one f-number, with fixed lens and Z_A.
struct DesignCurve {
  double f_number;
  std::vector<double> z_d;          ///< [m]
  std::vector<double> sensitivity;  ///< [px per kg/m^4]
  std::vector<double> resolution;   ///< wavelength of density with a transfer of 1/sqrt(2) [m]
  std::vector<double> cone;         ///< S_eps / (N (1 + M)), equal to the cone diameter by F23 [m]
};

/// Returns curves for the standard f-numbers from f/2.8 to f/32, with Z_D from 0.05 to 4 times Z_A.
std::vector<DesignCurve> design_curves(DesignPoint<double> const& bench);

/// Draws these curves, the setup as a point, the limit by the light cone alone, and the requirements as lines.
/// @param requirements  empty: no requirements
/// @throws GnuplotMissing, OutputError
void write_design_map(std::string const& path, DesignPoint<double> const& bench,
                      std::optional<Requirements> const& requirements);

/// Draws the best objective against the limit of a requirement.
void write_design_front(std::string const& path, Recommendation const& answer, Objective objective);

}  // namespace gladstone
