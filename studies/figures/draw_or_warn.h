#pragma once

#include <functional>

namespace gladstone::inline figures {

/// Calls a function that draws figures; without gnuplot, warns that they are not drawn.
/// @return false without gnuplot
bool draw_or_warn(std::function<void()> const& draw);

}  // namespace gladstone::inline figures
