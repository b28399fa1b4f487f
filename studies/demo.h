#pragma once

#include <string>

#include "studies/device.h"

namespace gladstone {

/// Runs the seed's experiment (Rajendran, Bane & Vlachos, section 4, Table 1) at both instants of the turbulence field,
/// from setup to error report: a CASE folder each, figure4.png and summary.md in `folder`.
/// @return the text of summary.md
std::string run_demo(std::string const& folder, Device const& device);

/// Folder of the files that gladstone brings along (studies/cases, data): beside the installed executable, or the
/// source tree.
std::string shared_folder();

}  // namespace gladstone
