#pragma once

#include <vector>

#include "render/scene/setup.h"
#include "studies/cameras.h"

namespace gladstone {

/// Gives all cameras of a setup one target (of PIV the same particles): the first camera's dots, on a target that
/// covers all views, at one place.
/// @param read what the cases' documents say, one by one
void share_target(std::vector<CameraCase>& cases, std::vector<Setup> const& read);

}  // namespace gladstone
