#pragma once

#include <string>
#include <vector>

#include "studies/drawing/figure.h"
#include "studies/figures/study_cells.h"

namespace gladstone::inline figures {

/// Common parts of the figures of a study.
namespace study_drawing {

/// Adds the title and a caption of at most two lines.
void add_texts(Figure& figure, std::string const& title, std::string const& caption);
/// Returns range, scale, ticks and title of the x axis.
/// @param width_px  width of the panel
plot::Axis make_x_axis(FigureAxis const& axis, double width_px);
/// Returns the ticks of an axis at given positions with its labels.
std::vector<plot::Tick> label_ticks(FigureAxis const& axis, std::vector<double> const& position);
/// Returns the space required below a panel for ticks and title of the axis [px].
int room_below(FigureAxis const& axis, double width_px);
/// Returns ticks, label and range of the y axis: logarithmic, or linear from zero if the values span less than a factor
/// of four.
plot::Axis make_y_axis(std::string const& title, double low, double high);
/// Returns e.g. "study NAME, 28 cases".
std::string study_name(StudyCells const& cells);
/// Returns the caption's explanation of points and bars.
std::string meaning(bool only_repeats_differ, std::size_t repeats);

}  // namespace study_drawing
}  // namespace gladstone::inline figures
