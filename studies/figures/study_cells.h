#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "studies/figures/study_axes.h"

namespace gladstone {

/// Most places of an axis in a figure.
inline constexpr std::size_t most_places = 12;

/// Places of sampled axes in maps, so that a cell has two of the study's points on average: sqrt(points / 2), 12 at
/// most; for fewer than 8 points, of which no map can be made, as many as elsewhere.
std::size_t sampled_places_in_maps(std::size_t points);

/// The finished cases of a study, sorted by the places of its axes: what every figure of it is drawn from.
class StudyCells {
 public:
  /// @param sampled_places most places of an axis of numbers that every point of the study has another one of, as
  ///                       "sobol" samples them
  explicit StudyCells(StudyTable const& table, std::size_t sampled_places = most_places);

  /// Axes that have more than one value.
  std::vector<std::size_t> const& varied() const { return varied_; }
  FigureAxis const& axis(std::size_t k) const { return axes_[k]; }
  std::string const& key(std::size_t k) const { return table_->axes[k].key; }
  StudyTable const& table() const { return *table_; }
  std::size_t finished() const { return finished_.size(); }

  /// Cases at these places of these axes, as indices of rows.
  std::vector<std::size_t> rows_at(std::map<std::size_t, std::size_t> const& places) const;
  /// Values of a measure in rows; empty where the study has no such measure.
  std::vector<double> values(std::string const& measure, std::vector<std::size_t> const& rows) const;
  /// Whether rows differ in repeats alone: all axes have the same value.
  bool repeats_alone(std::vector<std::size_t> const& rows) const;

 private:
  StudyTable const* table_;
  std::vector<FigureAxis> axes_;
  std::vector<std::size_t> varied_;
  std::vector<std::size_t> finished_;
};

/// A curve of a figure: a name, and the places of other axes that it stands for.
struct CurveChoice {
  std::string name;
  std::map<std::size_t, std::size_t> places;
};

/// What tells the curves over an axis apart: each combination of the other axes that there is, if `most` are enough;
/// else the values of the axis of fewest categories, if so; else one curve without a name.
std::vector<CurveChoice> curves_over(StudyCells const& cells, std::size_t axis, std::size_t most);

}  // namespace gladstone
