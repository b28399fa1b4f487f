#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/design/bench.h"
#include "studies/design/question.h"
#include "studies/design/recommend.h"

namespace gladstone {

/// Resolution against sensitivity as Z_D changes, for one f-number; the lens and Z_A stay.
struct DesignCurve {
  double f_number;
  std::vector<double> z_d;          ///< [m]
  std::vector<double> sensitivity;  ///< [px per kg/m^4]
  std::vector<double> resolution;   ///< wavelength that the chain passes with 1/sqrt(2) [m]
  std::vector<double> cone;         ///< S_eps / (N (1 + M)), which F23 says the cone to be [m]
};

/// Curves of the usual stops from f/2.8 to f/32, for Z_D from a twentieth to four times Z_A.
std::vector<DesignCurve> design_curves(Bench<double> const& bench);

/// Draws these curves, the setup as a point, the cone alone as the invariant has it, and what is required as lines.
/// @param requirements none: nothing is required
/// @throws GnuplotMissing, OutputError
void write_design_map(std::string const& path, Bench<double> const& bench,
                      std::optional<Requirements> const& requirements);

/// Draws the best objective against a requirement.
void write_design_front(std::string const& path, Recommendation const& answer, Objective objective);

}  // namespace gladstone
