#pragma once

#include <string>
#include <vector>

#include "studies/sweep/study_table.h"

namespace gladstone::inline figures {

/// Returns the title of an axis, e.g. "focal length [mm]" for "lens.focal_length_mm".
std::string axis_title(std::string const& key);

/// Returns a value with the name and unit of its axis: "Z_D = 250 mm" for the title "Z_D [mm]" and the label "250".
std::string axis_value_text(std::string const& title, std::string const& label);

/// An axis of a study as drawn in a figure: each position represents one value, or a bin of values if there are many.
struct FigureAxis {
  std::string title;
  bool numeric = true;  ///< numeric scale; else categories
  /// logarithmic scale: the numbers span more than a decade, or have a constant ratio
  bool logarithmic = false;
  bool binned = false;                ///< true: positions represent bins of values
  bool labelled = false;              ///< numeric scale with named positions
  std::vector<double> position;       ///< number (mean of a bin), or 0, 1, ... for categories
  std::vector<std::string> label;     ///< label of each position
  std::vector<std::size_t> place_of;  ///< position of each value of the study's axis

  std::size_t size() const { return position.size(); }
};

/// Converts an axis of a study. Numbers are sorted in ascending order; categories, and numbers that are not all finite,
/// have the study's order.
/// @param most  maximum number of positions; excess numbers are binned with equal counts, excess categories are merged
///              into the last position
FigureAxis figure_axis(StudyAxis const& axis, std::size_t most);

/// Value and range of a point in a figure.
struct Scatter {
  double centre, low, high;
};

/// Summarizes values: for repeats, root mean square, minimum and maximum; for cases that differ in more than dots and
/// noise, median and the 10 and 90 % quantiles. Non-finite values are ignored; NaN if none remain.
Scatter compute_scatter(std::vector<double> values, bool only_repeats_differ);

}  // namespace gladstone::inline figures
