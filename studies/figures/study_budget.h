#pragma once

#include <cstddef>
#include <optional>

#include "studies/drawing/figure.h"
#include "studies/figures/study_cells.h"

namespace gladstone::inline figures {

/// Returns a figure of the terms of the error budget along an axis; nullopt if no term is known.
/// @param points  averages of a study with repeats (study_points()), which separate estimator and pattern; else null
std::optional<Figure> make_budget(StudyCells const& cells, std::size_t axis, StudyCells const* points);

}  // namespace gladstone::inline figures
