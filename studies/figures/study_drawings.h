#pragma once

#include <memory>
#include <string>

#include "studies/figures/gnuplot.h"
#include "studies/figures/study_cells.h"

namespace gladstone {

/// Draw the figures of a study without writing them; null if the study has no finite values to show.
std::unique_ptr<GnuplotFigure> draw_error_curves(StudyCells const& cells, std::size_t axis);
std::unique_ptr<GnuplotFigure> draw_error_map(StudyCells const& cells, std::size_t x_axis, std::size_t y_axis);
/// @param points  averages of a study with repeats (study_points()), which separate estimator and pattern; else null
std::unique_ptr<GnuplotFigure> draw_budget(StudyCells const& cells, std::size_t axis, StudyCells const* points);
/// Draws the errors common to all repeats and those that differ between them.
/// @param points  averages of a study with repeats
std::unique_ptr<GnuplotFigure> draw_repeats(StudyCells const& points, std::size_t axis);

/// Common parts of the drawings.
namespace study_drawing {

/// Sets the title and a caption of at most two lines.
void set_texts(GnuplotFigure& plot, std::string const& title, std::string const& caption);
/// Sets range, scale, tics and title of the x axis.
/// @param width_px  width of the panel
void set_x_axis(GnuplotFigure& plot, FigureAxis const& axis, double width_px);
/// Returns the space required below a panel for tics and title of the axis [px].
int room_below(FigureAxis const& axis, double width_px);
/// Sets tics, label and range of the y axis: logarithmic, or linear from zero if the values span less than a factor of
/// four.
void set_y_axis(GnuplotFigure& plot, std::string const& title, double low, double high);
/// Returns e.g. "study NAME, 28 cases".
std::string study_name(StudyCells const& cells);
/// Returns the caption's explanation of points and bars.
std::string meaning(bool only_repeats_differ, std::size_t repeats);

}  // namespace study_drawing
}  // namespace gladstone
