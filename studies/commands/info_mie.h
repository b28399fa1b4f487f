#pragma once

#include <string>

#include "studies/commands/command.h"

namespace gladstone {

/// What `gladstone info mie` is asked.
struct MieQuestion {
  std::string x;       ///< size parameter pi d n / lambda
  std::string m;       ///< relative index, "RE" or "RE,IM"
  std::string figure;  ///< picture to draw; empty: none
};

/// Efficiencies of a sphere, and the light that it scatters over angle: S11 and polarization in steps of a degree, or
/// finer where its ripples are; draws it on polar paper with a logarithmic radius.
int describe_mie(MieQuestion const& question, GlobalOptions const& options);

}  // namespace gladstone
