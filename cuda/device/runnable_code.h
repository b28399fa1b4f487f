#pragma once

#include <string>

namespace gladstone::cuda {

/// Whether the current device can run what was compiled. @return empty, or why it cannot
std::string why_code_cannot_run();

}  // namespace gladstone::cuda
