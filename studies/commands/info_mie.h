#pragma once

#include <string>

#include "studies/commands/description.h"

namespace gladstone {

/// Arguments of `gladstone info mie`.
struct MieQuestion {
  std::string x;       ///< size parameter pi d n / lambda
  std::string m;       ///< relative index, "RE" or "RE,IM"
  std::string figure;  ///< path of the figure to draw; empty: none
};

/// Reports the efficiencies of a sphere and its scattered light over angle: S11 and polarization in steps of one
/// degree, or finer if required by the ripples. Draws the scattered light as a polar plot with logarithmic radius.
Description describe_mie(MieQuestion const& question);

}  // namespace gladstone
