#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/drawing/figure.h"
#include "studies/figures/study_cells.h"

namespace gladstone::inline figures {

/// Fraction of the errors against window-averaged truth that are within their estimated uncertainty.
inline constexpr char const* coverage_measure = "uncertainty.window_truth.coverage_1";

/// Makes the figures of a study; nullopt where the study has no finite values to show.
class StudyFigureMaker {
 public:
  explicit StudyFigureMaker(StudyTable const& table);
  StudyFigureMaker(StudyFigureMaker const&) = delete;

  /// Returns the axes with several values.
  std::vector<std::size_t> const& varied() const { return cells_.varied(); }
  /// Returns the title of an axis.
  std::string const& title(std::size_t axis) const { return cells_.axis(axis).title; }
  std::optional<Figure> make_errors(std::size_t axis) const;
  std::optional<Figure> make_budget(std::size_t axis) const;
  std::optional<Figure> make_repeats(std::size_t axis) const;  ///< nullopt for a study without repeats
  std::optional<Figure> make_coverage(std::size_t axis) const;
  std::optional<Figure> make_map(std::size_t x_axis, std::size_t y_axis) const;
  std::optional<Figure> make_case_points() const;

 private:
  StudyCells cells_, map_cells_;
  std::optional<StudyTable> point_table_;  ///< averages of the points of a study with repeats
  std::optional<StudyCells> points_;
};

/// Draws the figures of a study, each in every format:
///
/// - error_against_AXIS: error of the measurement against ray truth and Eq. 9 (PIV: the flow), with a curve for each
/// combination of the
///   other axes; without other axes, all references in one panel. With more combinations than colours, one curve for
///   each value of the axis with the fewest categories, or a single curve: median and 10-90 % band over all cases.
/// - error_map_AXIS_AXIS: the same errors against two axes, median over the others
/// - budget_AXIS: rms of each term of the error budget, side by side, and of the total
/// - repeats_AXIS: for studies with repeats: systematic part of both errors and standard deviation between repeats
/// Axes with a single value are ignored. Points are the root mean square over repeats; bars extend from minimum to
/// maximum. Unfinished cases are omitted; a study without finished cases has no figures.
/// @param folder   created if it does not exist
/// @param formats  "png", "svg", "pdf"
/// @return paths of the figures
/// @throws GnuplotMissing, OutputError
std::vector<std::string> draw_study(std::string const& folder, StudyTable const& table,
                                    std::vector<std::string> const& formats = {"png", "svg"});

}  // namespace gladstone::inline figures
