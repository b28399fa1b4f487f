#include "studies/figures/study_cells.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace gladstone::inline figures {
namespace {

/// Returns the name of a position, e.g. "Z_D = 250 mm"; for categories, the label.
std::string place_name(FigureAxis const& axis, std::size_t place) {
  return axis.numeric ? axis_value_text(axis.title, axis.label[place]) : axis.label[place];
}

}  // namespace

std::size_t sampled_places_in_maps(std::size_t points) {
  if (points < 8) return max_positions;
  return std::min(max_positions, static_cast<std::size_t>(std::sqrt(static_cast<double>(points) / 2.0)));
}

StudyCells::StudyCells(StudyTable const& table, std::size_t sampled_places) : table_(&table) {
  for (std::size_t k = 0; k < table.axes.size(); ++k) {
    StudyAxis const& axis = table.axes[k];
    axes_.push_back(figure_axis(axis, max_positions));
    if (axes_[k].numeric && axis.labels.size() == table.points.size()) axes_[k] = figure_axis(axis, sampled_places);
    if (axes_[k].size() > 1) varied_.push_back(k);
  }
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    if (table.rows[i].status == CaseStatus::ok) finished_.push_back(i);
  }
}

std::vector<std::size_t> StudyCells::rows_at(std::map<std::size_t, std::size_t> const& places) const {
  std::vector<std::size_t> rows;
  std::copy_if(finished_.begin(), finished_.end(), std::back_inserter(rows), [&](std::size_t row) {
    return std::all_of(places.begin(), places.end(), [&](auto const& place) {
      return axes_[place.first].place_of[table_->rows[row].value[place.first]] == place.second;
    });
  });
  return rows;
}

std::vector<double> StudyCells::values(std::string const& measure, std::vector<std::size_t> const& rows) const {
  std::vector<double> found;
  if (auto const place = table_->find_measure(measure)) {
    for (std::size_t const row : rows) found.push_back(table_->rows[row].measures[*place]);
  }
  return found;
}

bool StudyCells::only_repeats_differ(std::vector<std::size_t> const& rows) const {
  return std::all_of(rows.begin(), rows.end(),
                     [&](std::size_t row) { return table_->rows[row].value == table_->rows[rows.front()].value; });
}

std::vector<CurveChoice> curves_over(StudyCells const& cells, std::size_t axis, std::size_t most) {
  std::vector<std::size_t> others;
  for (std::size_t const k : cells.varied()) {
    if (k != axis) others.push_back(k);
  }
  // Combinations of positions on the other axes, with the positions of this axis that occur.
  std::map<std::vector<std::size_t>, std::set<std::size_t>> combinations;
  for (std::size_t const row : cells.rows_at({})) {
    std::vector<std::size_t> const& value = cells.table().rows[row].value;
    std::vector<std::size_t> combination;
    for (std::size_t const k : others) combination.push_back(cells.axis(k).place_of[value[k]]);
    combinations[combination].insert(cells.axis(axis).place_of[value[axis]]);
  }
  bool const curves = std::any_of(combinations.begin(), combinations.end(),
                                  [](auto const& combination) { return combination.second.size() > 1; });
  std::vector<CurveChoice> choices;
  if (!others.empty() && curves && combinations.size() <= most) {
    for (auto const& [combination, places] : combinations) {
      CurveChoice choice;
      for (std::size_t i = 0; i < others.size(); ++i) {
        choice.name += (i > 0 ? ", " : "") + place_name(cells.axis(others[i]), combination[i]);
        choice.places[others[i]] = combination[i];
      }
      choices.push_back(std::move(choice));
    }
    return choices;
  }
  std::size_t chosen = axis;
  for (std::size_t const k : others) {
    if (cells.axis(k).numeric || cells.axis(k).size() > most) continue;
    if (chosen == axis || cells.axis(k).size() < cells.axis(chosen).size()) chosen = k;
  }
  if (chosen == axis || !curves) return {{}};
  for (std::size_t place = 0; place < cells.axis(chosen).size(); ++place) {
    choices.push_back({place_name(cells.axis(chosen), place), {{chosen, place}}});
  }
  return choices;
}

}  // namespace gladstone::inline figures
