#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "studies/figures/study_drawings.h"
#include "studies/sweep/ranking.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;
using namespace study_drawing;

/// Returns the axis of a measure: logarithmic if the values span more than a factor of four.
Axis make_measure_axis(std::string const& label, std::vector<double> const& values) {
  auto const [low, high] = std::minmax_element(values.begin(), values.end());
  Axis axis = make_y_axis(label, *low, *high);
  if (!axis.logarithmic) axis.low = axis.high = automatic;
  return axis;
}

/// Returns number and values of a case, as shown at the pointer.
std::string describe_case(StudyTable const& table, StudyRow const& row) {
  std::string text = fmt::format("case {}", row.index);
  for (std::size_t k = 0; k < table.axes.size(); ++k)
    text += '\n' + axis_value_text(axis_title(table.axes[k].key), table.axes[k].labels[row.value[k]]);
  return text;
}

}  // namespace

std::optional<Figure> make_case_points(StudyCells const& cells) {
  std::vector<ErrorMeasure> const errors = known_errors(cells);
  std::string const measure = main_error_measure(cells.table());
  auto const error =
      std::find_if(errors.begin(), errors.end(), [&](auto const& one) { return one.measure == measure; });
  if (error == errors.end()) return std::nullopt;
  std::vector<std::size_t> const rows = cells.rows_at({});
  std::vector<double> const x = cells.values(signal_measure, rows), y = cells.values(measure, rows);
  Layer points{.kind = Layer::Kind::points, .columns = {{}, {}}, .colour = house_colour(0), .marker = 1, .size = 0.8};
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
    points.columns[0].push_back(x[i]);
    points.columns[1].push_back(y[i]);
    std::string text = describe_case(cells.table(), cells.table().rows[rows[i]]);
    text += fmt::format("\nsignal: {:.4g} px\n{}: {:.4g} px", x[i], error->name, y[i]);
    points.notes.push_back(std::move(text));
  }
  if (points.notes.empty()) return std::nullopt;
  Figure figure{772, 500};
  add_texts(figure, "Error against the signal", study_name(cells) + "; one point per case");
  Panel panel{.box = {92, 752, 52, 412}, .grid = Grid::both};
  panel.x = make_measure_axis("signal: rms of the ray truth [px]", points.columns[0]);
  panel.y = make_measure_axis(error->name + ", rms per component [px]", points.columns[1]);
  panel.layers.push_back(std::move(points));
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace gladstone::inline figures
