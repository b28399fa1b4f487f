#pragma once

#include <string>
#include <vector>

#include "studies/compare/compare.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Figures of a comparison by their file names, which case_file::derived (studies/case/case_files.h) lists. Maps and
/// local gradients require vectors on a grid.
std::vector<NamedFigure> make_comparison_figures(Comparison const& comparison);

/// Draws the figures of a comparison into a folder.
/// @param format  "png", "svg" or "pdf"
/// @return paths of the figures
/// @throws GnuplotMissing, OutputError
std::vector<std::string> draw_comparison(std::string const& folder, Comparison const& comparison,
                                         std::string const& format = "png");

}  // namespace gladstone::inline figures
