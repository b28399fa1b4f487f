#pragma once

#include <string>

#include "studies/device.h"

namespace gladstone {

/// Runs the seed's experiment (Rajendran, Bane & Vlachos, section 4, Table 1) at both instants of the turbulence field:
/// first on a field as coarse as the authors' sample, from setup to error report (a CASE folder each, figure4.png),
/// then with rays and theory alone as the field gets finer (agreement.png). summary.md tells what came out, README's
/// passage first.
/// @return the text of summary.md
std::string run_demo(std::string const& folder, Device const& device);

/// Folder of the files that gladstone brings along (studies/cases, data): beside the installed executable, or the
/// source tree.
std::string shared_folder();

}  // namespace gladstone
