#include "studies/commands/info_field.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

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

nlohmann::json json_of(Vec3d const& values) {
  return {number_or_null(values.x), number_or_null(values.y), number_or_null(values.z)};
}

/// Describes the steepest differences, "steepest difference between neighbours 0.02, 0.05, unknown per unit length
/// along x, y, z".
std::string steepest_text(Vec3d const& steepest, FieldPlace const& place) {
  std::string text;
  bool any = false;
  for (int axis = 0; axis < 3; ++axis) {
    any = any || std::isfinite(place.spacing[axis]);
    text += axis > 0 ? ", " : "";
    text += std::isfinite(steepest[axis]) ? fmt::format("{:.4g}", steepest[axis]) : "unknown";
  }
  return "steepest difference between neighbours " + text + (any ? " per unit length" : "") + " along x, y, z";
}

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

/// Returns a property of the components for JSON: one value for a scalar field, an array of values for a velocity.
template <class Value>
nlohmann::json of_components(std::vector<FieldStatistics> const& seen, Value const& value_of) {
  if (seen.size() == 1) return value_of(seen.front());
  nlohmann::json all = nlohmann::json::array();
  for (FieldStatistics const& one : seen) all.push_back(value_of(one));
  return all;
}

/// Describes the values: "values 1 to 2, steepest difference ...", for a velocity of each component.
std::string values_text(std::vector<FieldStatistics> const& seen, FieldPlace const& place) {
  std::string text;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    text += fmt::format("{}{} {:.6g} to {:.6g}, {}", text.empty() ? "" : "; ",
                        seen.size() == 1 ? "values" : std::string(1, "uvw"[i]), seen[i].minimum, seen[i].maximum,
                        steepest_text(seen[i].steepest, place));
  }
  return text;
}

}  // namespace

Description describe_field(std::string const& path, std::string const& dataset, std::string const& axes,
                           std::string const& setup, std::string const& figure) {
  auto const source = open_scalar_or_velocity(path, dataset, axes);
  RegularGrid const& grid = source->grid();
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
  nlohmann::json json{
      {"dataset", source->name()},
      {"nodes", {grid.nodes[0], grid.nodes[1], grid.nodes[2]}},
      {"spacing", json_of(place.spacing)},
      {"components", source->values()},
      {"minimum", of_components(seen, [](FieldStatistics const& one) -> nlohmann::json { return one.minimum; })},
      {"maximum", of_components(seen, [](FieldStatistics const& one) -> nlohmann::json { return one.maximum; })},
      {"steepest_gradient", of_components(seen, [](FieldStatistics const& one) { return json_of(one.steepest); })},
      {"axes",
       {{"order", reading.axes}, {"by", reading.by}, {"shape", reading.shape}, {"turned_round", reading.turned_round}}},
      {"notes", to_strings(notes)},
      {"units", units_json(source->units())},
      {"extent_mm", json_of(place.extent_mm)},
      {"coverage", coverage_json(place, setup)}};
  if (!figure.empty() && draw_field(figure, *source, place)) json["figure"] = figure;
  return {json_text(json),
          fmt::format("{}: {} x {} x {} nodes, {}, {}; {}; {}", source->name(), grid.nodes[0], grid.nodes[1],
                      grid.nodes[2], place.spacing_text, values_text(seen, place), reading.text(), place.text)};
}

}  // namespace gladstone::inline commands
