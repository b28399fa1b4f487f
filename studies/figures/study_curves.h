#pragma once

#include <cstddef>
#include <optional>

#include "studies/drawing/figure.h"
#include "studies/figures/study_cells.h"

namespace gladstone::inline figures {

/// Returns a figure of the errors along an axis; nullopt if the study has no finite values to show.
std::optional<Figure> make_error_curves(StudyCells const& cells, std::size_t axis);

/// Returns a figure of the errors that are common to all repeats, and of the scatter between repeats.
/// @param points  averages of a study with repeats
std::optional<Figure> make_repeats(StudyCells const& points, std::size_t axis);

}  // namespace gladstone::inline figures
