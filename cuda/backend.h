#pragma once

#include <string>

namespace gladstone::cuda {

/// Whether this executable can render and correlate on a CUDA device.
bool compiled_in();

/// One line for `--version`: the CUDA toolkit that the build saw, and what it was used for.
std::string description();

}  // namespace gladstone::cuda
