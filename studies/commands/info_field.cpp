#include "studies/commands/info_field.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "render/base/units.h"
#include "render/base/vec.h"
#include "render/files/fields/field_file.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/commands/field_place.h"
#include "studies/commands/field_statistics.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/draw_or_warn.h"
#include "studies/figures/field_figure.h"

namespace gladstone::inline commands {
namespace {

/// Draws the planes through the middle of a field. @return false without gnuplot
bool draw_field(std::string const& path, FieldSource& source, FieldPlace const& place) {
  bool known = true;
  for (int axis = 0; axis < 3; ++axis) known = known && std::isfinite(place.extent_mm[axis]);
  return draw_or_warn([&] { draw_figure(make_field_figure(source, known), path); });
}

/// Opens a scalar field, or a velocity if the file has no scalar field of this name, or several.
/// @throws DataError about the scalar field if the file contains neither
std::unique_ptr<FieldSource> open_scalar_or_velocity(std::string const& path, std::string const& dataset,
                                                     std::string const& axes) {
  try {
    return open_field(path, dataset, 1, axes);
  } catch (DataError const& error) {
    bool const other = error.code() == ErrorCode::missing_content || error.code() == ErrorCode::wrong_shape ||
                       error.code() == ErrorCode::undetermined;
    if (!other) throw;
    try {
      return open_field(path, dataset, 3, axes);
    } catch (DataError const&) {
    }
    throw;
  }
}

/// Quantities of a field, those along an axis and of a component with their indices as the last parts of the keys.
std::vector<ResultRow> make_field_rows(FieldSource const& source, std::vector<FieldStatistics> const& seen,
                                       FieldPlace const& place) {
  FieldUnits const& units = source.units();
  std::vector<ResultRow> rows;
  auto const add = [&rows](std::string key, std::string label, double value, std::string const& unit = "",
                           char const* note = "") -> ResultRow& {
    return rows.emplace_back(
        ResultRow{.key = std::move(key), .label = std::move(label), .value = value, .unit = unit, .note = note});
  };
  auto const add_axes = [&add](std::string const& key, std::string const& label, Vec3d const& values,
                               std::string const& unit) {
    for (int axis = 0; axis < 3; ++axis)
      add(fmt::format("{}.{}", key, axis), fmt::format("{} along {}", label, "xyz"[axis]), values[axis], unit);
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    add(fmt::format("nodes.{}", axis), fmt::format("nodes along {}", "xyz"[axis]), source.grid().nodes[axis]).whole =
        true;
  }
  for (int axis = 0; axis < 3; ++axis) {
    bool const single = source.grid().nodes[static_cast<std::size_t>(axis)] == 1;
    add(fmt::format("spacing.{}", axis), fmt::format("spacing along {}", "xyz"[axis]), place.spacing[axis],
        units.length,
        std::isfinite(place.spacing[axis]) ? ""
        : single                           ? "one node"
                                           : "not stated in the file");
  }
  add_axes("extent_mm", "extent", place.extent_mm, "mm");
  add("components", "components", source.values()).whole = true;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    std::string const index = seen.size() == 1 ? "" : fmt::format(".{}", i);
    std::string const of = seen.size() == 1 ? "" : fmt::format(" of {}", "uvw"[i]);
    add("minimum" + index, "smallest value" + of, seen[i].minimum, units.values);
    add("maximum" + index, "largest value" + of, seen[i].maximum, units.values);
    add_axes("steepest_gradient" + index, "steepest difference" + of + " per unit length", seen[i].steepest, "");
  }
  if (!place.coverage) return rows;
  add("coverage.share", "fraction of the view that it fills", place.coverage->share);
  add("coverage.view_mm.0", "width of the view", place.coverage->view.x / unit::millimetre, "mm");
  add("coverage.view_mm.1", "height of the view", place.coverage->view.y / unit::millimetre, "mm");
  return rows;
}

}  // namespace

Description describe_field(std::string const& path, std::string const& dataset, std::string const& axes,
                           std::string const& setup, std::string const& figure) {
  auto const source = open_scalar_or_velocity(path, dataset, axes);
  std::vector<FieldStatistics> seen = field_statistics(*source);
  FieldPlace const place = field_place(*source, {path, dataset, axes}, setup);
  for (FieldStatistics& one : seen) {  // convert differences to differences per unit length, which are unknown along an
                                       // axis of undefined spacing
    for (int axis = 0; axis < 3; ++axis) {
      if (std::isnan(place.spacing[axis]) && std::isnan(place.extent_mm[axis]))
        one.steepest[axis] = place.spacing[axis];
    }
  }
  AxisAssignment const& reading = source->reading();
  Warnings const notes = source->notes();
  for (Warning const& note : notes) log_warning(at_place(path, note));
  if (!place.assumption.empty()) log_warning({WarningCode::assumed, path, place.assumption});
  std::vector<ResultRow> rows = make_field_rows(*source, seen, place);
  nlohmann::json json(rows_json(rows));
  json.update({{"dataset", source->name()},
               {"axes",
                {{"order", reading.axes},
                 {"by", reading.by},
                 {"shape", reading.shape},
                 {"turned_round", reading.turned_round}}},
               {"notes", to_strings(notes)},
               {"units", units_json(source->units())}});
  if (place.coverage) {
    json["coverage"]["setup"] = setup;
  } else {
    json["coverage"] = nullptr;
  }
  if (!figure.empty() && draw_field(figure, *source, place)) json["figure"] = figure;
  std::string text = fmt::format("{}: {}\n{}  {}\n", source->name(), reading.text(), rows_text(rows), place.text);
  return {json_text(json), std::move(text), std::move(rows)};
}

}  // namespace gladstone::inline commands
