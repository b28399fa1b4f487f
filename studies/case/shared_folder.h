#pragma once

#include <string>

namespace gladstone::inline cases {

/// Returns the folder of the files installed with gladstone (studies/cases, data): relative to the installed
/// executable or Python module; for executables in the build folder, the source tree.
/// @throws DataError (missing_file) if the installation is incomplete
std::string shared_folder();

}  // namespace gladstone::inline cases
