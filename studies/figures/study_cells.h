#pragma once

#include <map>
#include <string>
#include <vector>

#include "studies/figures/study_axes.h"

namespace gladstone::inline figures {

/// Maximum number of positions on an axis of a figure.
inline constexpr std::size_t max_positions = 12;

/// Returns the number of positions of sampled axes in maps, for an average of two points per cell: sqrt(points / 2), at
/// most 12; for fewer than 8 points, which do not suffice for a map, max_positions.
std::size_t sampled_places_in_maps(std::size_t points);

/// Finished cases of a study, sorted by the positions on its axes; data source of all its figures.
class StudyCells {
 public:
  /// @param sampled_places  maximum number of positions on a numeric axis that "sobol" sampled, which has a different
  /// value in every point of the study
  explicit StudyCells(StudyTable const& table, std::size_t sampled_places = max_positions);

  /// Returns the axes with more than one value.
  std::vector<std::size_t> const& varied() const { return varied_; }
  FigureAxis const& axis(std::size_t k) const { return axes_[k]; }
  std::string const& key(std::size_t k) const { return table_->axes[k].key; }
  StudyTable const& table() const { return *table_; }
  std::size_t finished() const { return finished_.size(); }

  /// Returns the row indices of the cases at given positions.
  /// @param places  position by axis
  std::vector<std::size_t> rows_at(std::map<std::size_t, std::size_t> const& places) const;
  /// Returns the values of a measure in rows; empty if the study does not have the measure.
  std::vector<double> values(std::string const& measure, std::vector<std::size_t> const& rows) const;
  /// Returns true if rows differ by repeats only, that is, if all axes have the same value.
  bool only_repeats_differ(std::vector<std::size_t> const& rows) const;

 private:
  StudyTable const* table_;
  std::vector<FigureAxis> axes_;
  std::vector<std::size_t> varied_;
  std::vector<std::size_t> finished_;
};

/// A curve of a figure: name and positions on the other axes.
struct CurveChoice {
  std::string name;
  std::map<std::size_t, std::size_t> places;
};

/// Selects the curves against an axis: each combination of the other axes if there are at most `most`; else the values
/// of the axis with the fewest categories, if at most `most`; else a single curve without a name.
std::vector<CurveChoice> curves_over(StudyCells const& cells, std::size_t axis, std::size_t most);

}  // namespace gladstone::inline figures
