#pragma once

#include <string>

namespace gladstone {

/// Returns the folder of the files installed with gladstone (studies/cases, data): relative to the installed
/// executable, or the source tree.
std::string shared_folder();

}  // namespace gladstone
