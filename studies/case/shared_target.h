#pragma once

#include <vector>

#include "render/scene/setup.h"
#include "studies/case/cameras.h"

namespace gladstone::inline cases {

/// Replaces the target of every camera's setup by a common one: the first camera's dots, on a target at one position
/// that covers all views.
/// @param cases  setups to be changed
/// @param read   the same setups, read
void share_target(std::vector<CameraCase>& cases, std::vector<Setup> const& read);

}  // namespace gladstone::inline cases
