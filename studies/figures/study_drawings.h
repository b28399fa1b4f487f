#pragma once

#include <memory>
#include <string>

#include "studies/figures/gnuplot.h"
#include "studies/figures/study_cells.h"

namespace gladstone {

/// The figures of a study, not yet written. Null where the study has no finite number to show.
std::unique_ptr<GnuplotFigure> draw_error_curves(StudyCells const& cells, std::size_t axis);
std::unique_ptr<GnuplotFigure> draw_error_map(StudyCells const& cells, std::size_t x_axis, std::size_t y_axis);
/// @param points of a study with repeats (study_points()): estimator and pattern are told apart there; else null
std::unique_ptr<GnuplotFigure> draw_budget(StudyCells const& cells, std::size_t axis, StudyCells const* points);
/// What is the same in every repeat and what changes between them. @param points of a study with repeats
std::unique_ptr<GnuplotFigure> draw_repeats(StudyCells const& points, std::size_t axis);

/// What the drawings have in common.
namespace study_drawing {

/// Title above and caption below, at most two lines.
void set_texts(GnuplotFigure& plot, std::string const& title, std::string const& caption);
/// A panel's place, in pixels from the upper left of the figure.
void place(GnuplotFigure& plot, double left, double right, double top, double bottom);
/// Range, scale, tics and title of a figure's x axis. @param width_px of the panel
void set_x_axis(GnuplotFigure& plot, FigureAxis const& axis, double width_px);
/// Room below a panel for tics and title of that axis [px].
int room_below(FigureAxis const& axis, double width_px);
/// Tics, label and range of a logarithmic y axis over these values, or of one from zero where they span less than a
/// factor of four.
void set_y_axis(GnuplotFigure& plot, std::string const& title, double low, double high);
/// "study NAME, 28 cases"
std::string study_name(StudyCells const& cells);
/// What points or bars stand for, where rows of one of them are such.
std::string meaning(bool repeats_alone, std::size_t repeats);

}  // namespace study_drawing
}  // namespace gladstone
