#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/drawing/figure.h"
#include "studies/figures/study_cells.h"

namespace gladstone::inline figures {

/// Figures of a study; nullopt if the study has no finite values to show.
std::optional<Figure> make_error_curves(StudyCells const& cells, std::size_t axis);
std::optional<Figure> make_error_map(StudyCells const& cells, std::size_t x_axis, std::size_t y_axis);
/// @param points  averages of a study with repeats (study_points()), which separate estimator and pattern; else null
std::optional<Figure> make_budget(StudyCells const& cells, std::size_t axis, StudyCells const* points);
/// Returns a figure of the errors that are common to all repeats, and of the scatter between repeats.
/// @param points  averages of a study with repeats
std::optional<Figure> make_repeats(StudyCells const& points, std::size_t axis);
/// Returns a figure of the fraction of the errors that the estimated uncertainty covers.
std::optional<Figure> make_coverage(StudyCells const& cells, std::size_t axis);
/// Returns a figure of the error against the signal, with one point per case.
std::optional<Figure> make_case_points(StudyCells const& cells);

/// Common parts of the figures of a study.
namespace study_drawing {

/// rms of the ray truth.
inline constexpr char const* signal_measure = "signal_px";

/// rms error of the measurement against one reference.
struct ErrorMeasure {
  std::string measure;
  std::string name;
};
/// Returns the errors that are known in some case. The first two are those against ray truth and against Eq. 9, or for
/// PIV against the flow.
std::vector<ErrorMeasure> known_errors(StudyCells const& cells);

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
