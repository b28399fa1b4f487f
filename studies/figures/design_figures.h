#pragma once

#include <string>
#include <vector>

#include "studies/design/design.h"

namespace gladstone::inline figures {

/// Draws the optical layout, the design map and, if requirements trade off against each other, the front of a design.
/// Without gnuplot, only warns.
/// @param format  "png", "svg" or "pdf"
/// @return paths of the figures
std::vector<std::string> draw_design(DesignReport const& report, std::string const& folder, std::string const& format);

}  // namespace gladstone::inline figures
