#pragma once

#include <vector>

#include "studies/case/cameras.h"

namespace gladstone::inline cases {

/// Replaces the target of every camera's setup by a common one: the first camera's dots, on a target at one position
/// that covers all views.
void share_target(std::vector<CameraCase>& cameras);

}  // namespace gladstone::inline cases
