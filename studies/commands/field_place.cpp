#include "studies/commands/field_place.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "render/base/units.h"
#include "render/light/velocity_file.h"
#include "render/medium/field_volume.h"
#include "studies/case/case.h"

namespace gladstone::inline commands {
namespace {

nlohmann::json named(std::string const& unit) { return unit.empty() ? nlohmann::json(nullptr) : nlohmann::json(unit); }

constexpr double undefined_length = std::numeric_limits<double>::quiet_NaN();

/// Returns the spacings that the file states, in its unit of length; NaN for the others and for axes of a single node.
Vec3d stated_spacing(FieldSource const& source) {
  Vec3d spacing = source.grid().spacing;
  for (int axis = 0; axis < 3; ++axis) {
    bool const stated = source.units().unspaced.find("xyz"[axis]) == std::string::npos;
    if (!stated || source.grid().nodes[static_cast<std::size_t>(axis)] == 1) spacing[axis] = undefined_length;
  }
  return spacing;
}

/// Returns the distance from the first node to the last along each axis [mm]; NaN where the spacing is undefined.
Vec3d extent_mm(FieldSource const& source) {
  FieldUnits const& units = source.units();
  Vec3d extent{};
  for (int axis = 0; axis < 3; ++axis) {
    auto const nodes = source.grid().nodes[static_cast<std::size_t>(axis)];
    bool const undefined = !units.undefined().empty() && nodes > 1 &&
                           (units.unspaced.empty() || units.unspaced.find("xyz"[axis]) != std::string::npos);
    extent[axis] =
        undefined ? undefined_length : source.grid().spacing[axis] * units.metres() / unit::millimetre * (nodes - 1);
  }
  return extent;
}

/// Returns the region of a density field in the world, with the spacing and centre that the setup gives its field [m].
Bounds<double> density_region(Setup const& setup, FieldSource const& source, FieldFile const& file) {
  MediumSetup medium = setup.medium;
  FieldSetup& field = medium.field;
  if (field.kind != FieldKind::file) field = {};
  field.kind = FieldKind::file;
  field.file = file.path;
  field.dataset = file.dataset;
  field.axes = file.axes;
  field.extrude = source.grid().nodes[2] == 1;
  return file_bounds(medium);
}

/// Returns the velocity file of a setup; null if it names none.
VelocityFile const* find_velocity_file(Setup const& setup) {
  return setup.piv && setup.piv->flow.file ? &*setup.piv->flow.file : nullptr;
}

/// Returns the region of a velocity field in the world, with the spacing and centre that the setup gives its flow [m].
Bounds<double> velocity_region(Setup const& setup, FieldSource const& source, FieldFile const& file) {
  VelocityFile velocity;
  if (VelocityFile const* const given = find_velocity_file(setup)) velocity = *given;
  velocity.file = file.path;
  velocity.dataset = file.dataset;
  velocity.axes = file.axes;
  velocity.extrude = source.grid().nodes[2] == 1;
  RegularGrid const grid = velocity_grid(velocity);
  Vec3d high = grid.origin;
  for (int axis = 0; axis < 3; ++axis)
    high[axis] += grid.spacing[axis] * (grid.nodes[static_cast<std::size_t>(axis)] - 1);
  return {grid.origin, high};
}

/// Returns true if the setup specifies the spacing of the field's nodes.
bool is_spaced(Setup const& setup, bool velocity) {
  if (!velocity) return setup.medium.field.kind == FieldKind::file && setup.medium.field.spacing.has_value();
  VelocityFile const* const given = find_velocity_file(setup);
  return given && given->spacing.has_value();
}

}  // namespace

FieldPlace field_place(FieldSource const& source, FieldFile const& file, std::string const& setup) {
  bool const velocity = source.values() > 1;
  std::string const spacing_key = velocity ? "flow.spacing_mm" : "medium.field.spacing_mm";
  FieldUnits const& units = source.units();
  std::string const undefined = units.undefined(), assumed = undefined.empty() ? units.assumed() : "";
  FieldPlace place;
  place.spacing = stated_spacing(source);
  place.extent_mm = extent_mm(source);
  std::string const values = units.values.empty() ? "have no stated unit" : "are in " + units.values;
  if (undefined.empty()) {
    place.text = fmt::format("{} unless spacing_mm is given; values {}",
                             assumed.empty() ? "lengths are in " + units.length : assumed, values);
  } else {
    place.text = fmt::format("{}, so that spacing_mm must be given; values {}", undefined, values);
    place.assumption = undefined + "; give " + spacing_key;
  }
  if (!assumed.empty()) place.assumption = assumed + "; if that is wrong, give " + spacing_key;
  if (setup.empty()) return place;

  Setup const whole = load_case_setup(setup, {}).setup;
  if (is_spaced(whole, velocity)) place.assumption.clear();
  FieldCoverage const& seen = place.coverage.emplace(
      field_coverage(velocity ? velocity_region(whole, source, file) : density_region(whole, source, file), whole));
  if (auto const warning = seen.warning(); warning && !velocity) place.text += "; " + to_string(*warning);
  return place;
}

nlohmann::json units_json(FieldUnits const& units) {
  std::string const undefined = units.undefined(), assumed = undefined.empty() ? units.assumed() : "";
  return {{"length", named(units.length)},
          {"length_m", undefined.empty() ? nlohmann::json(units.metres()) : nlohmann::json(nullptr)},
          {"assumed", named(assumed)},
          {"unknown", named(undefined)},
          {"values", named(units.values)}};
}

}  // namespace gladstone::inline commands
