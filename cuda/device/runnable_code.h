#pragma once

#include <string>

namespace gladstone::cuda::inline device {

/// Returns the reason why the current device cannot run the compiled code; empty if it can.
std::string reason_code_cannot_run();

}  // namespace gladstone::cuda::inline device
