#pragma once

#include <string>
#include <vector>

#include "studies/sweep/study_table.h"

namespace gladstone {

/// How a figure names an axis: "focal length [mm]" for "lens.focal_length_mm".
std::string axis_title(std::string const& key);

/// An axis as a figure shows it: a few places, each of one value or, of many numbers, of a bin of them.
struct FigureAxis {
  std::string title;
  bool numeric = true;                ///< a scale; else a row of categories
  bool logarithmic = false;           ///< the scale: the numbers span more than a decade, or step by a factor
  bool binned = false;                ///< places are bins of values
  bool labelled = false;              ///< a scale whose places have names of their own
  std::vector<double> position;       ///< of each place: the number (of a bin, the mean), or 0, 1, ... for categories
  std::vector<std::string> label;     ///< of each place
  std::vector<std::size_t> place_of;  ///< for each value of the study's axis

  std::size_t size() const { return position.size(); }
};

/// Numbers grow from place to place; categories keep the study's order, as do numbers of which one is not finite.
/// @param most places; of more numbers, bins of equal count are made; of more categories, the last place takes the rest
FigureAxis figure_axis(StudyAxis const& axis, std::size_t most);

/// What a point of a figure stands for, and how far it scatters.
struct Scatter {
  double centre, low, high;
};

/// Of repeats: the root mean square, the smallest and the largest; of cases that differ in more than dots and noise:
/// the median and the quantiles 10 and 90 %. Values that are not finite are left out; of none, NaN.
Scatter scatter_of(std::vector<double> values, bool repeats_alone);

/// Tics for gnuplot at 1, 2 and 5 times powers of ten, or at these alone where there are many. @pre 0 < low < high
std::string logarithmic_tics(double low, double high);

}  // namespace gladstone
