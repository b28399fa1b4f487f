#pragma once

#include <string>
#include <vector>

#include "studies/compare/compare.h"

namespace gladstone {

/// Draws displacement maps, error histograms, error against gradient and the budget into a folder.
/// @param format  "png", "svg" or "pdf"
/// @return paths of the figures
std::vector<std::string> draw_comparison(std::string const& folder, Comparison const& comparison,
                                         std::string const& format = "png");

}  // namespace gladstone
