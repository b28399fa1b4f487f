#pragma once

#include <string>

#include "studies/case/backend.h"

namespace gladstone::inline examples {

/// Reproduces the experiment of Rajendran et al. (2019, section 4, Table 1) at both instants of the turbulence field:
/// first on a field as coarse as the authors' sample, from setup to error report (one CASE folder each, figure4.png);
/// then by rays and theory alone on increasingly fine fields (agreement.png). Writes summary.md, whose first
/// section is docs/demo.md.
/// @return text of summary.md
std::string run_demo(std::string const& folder, Backend const& device);

}  // namespace gladstone::inline examples
