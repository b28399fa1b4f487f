#pragma once

#include <vector>

#include "render/files/input_guard.h"

namespace gladstone::inline commands {

/// Returns the files of studies, cases and benchmark cases that only the commands making them may write.
std::vector<ProtectedFiles> protected_files();

}  // namespace gladstone::inline commands
