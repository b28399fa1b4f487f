#pragma once

#include <cstddef>

#include "render/setup/setup_state.h"

namespace gladstone::inline setup {

/// Adds problems for the keys that were not read, at most max_reported_problems.
/// @return number of such keys
std::size_t add_unread(SetupDocument::State& state);

}  // namespace gladstone::inline setup
