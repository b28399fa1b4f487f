#pragma once

#include <complex>
#include <string>

#include "studies/commands/description.h"

namespace gladstone::inline commands {

/// A homogeneous sphere in a plane wave.
struct MieQuestion {
  double x = 0.0;           ///< size parameter pi d n / lambda [1]
  std::complex<double> m;   ///< refractive index relative to the surroundings, n + i k [1]
  std::string figure = {};  ///< path of the figure to draw; empty: none
};

/// Reads the options --x and --m, "RE" or "RE,IM". @throws DataError if one is missing or not a number
MieQuestion read_mie_question(std::string const& x, std::string const& m);

/// Reports the efficiencies of a sphere and its scattered light over angle: S11 and polarization in steps of one
/// degree, or finer if required by the ripples. Draws the scattered light as a polar plot with logarithmic radius.
/// @throws DataError at the place --x or --m if it is out of range
Description describe_mie(MieQuestion const& question);

}  // namespace gladstone::inline commands
