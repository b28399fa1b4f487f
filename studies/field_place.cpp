#include "studies/field_place.h"

#include <fmt/format.h>

#include "render/base/units.h"
#include "render/medium/field_volume.h"
#include "render/scene/field_coverage.h"
#include "studies/case.h"

namespace gladstone {
namespace {

nlohmann::json named(std::string const& unit) { return unit.empty() ? nlohmann::json(nullptr) : nlohmann::json(unit); }

/// Returns a setup with its field replaced by this one.
Setup with_field(std::string const& setup, FieldSource const& source, std::string const& path,
                 std::string const& dataset, std::string const& axes) {
  Setup whole = load_case_setup(setup, {}).setup;
  FieldSetup& field = whole.medium.field;
  if (field.kind != FieldKind::file) field = {};
  field.kind = FieldKind::file;
  field.file = path;
  field.dataset = dataset;
  field.axes = axes;
  field.extrude = source.grid().nodes[2] == 1;
  return whole;
}

}  // namespace

FieldPlace field_place(FieldSource const& source, std::string const& path, std::string const& dataset,
                       std::string const& axes, std::string const& setup) {
  FieldUnits const& units = source.units();
  RegularGrid const& grid = source.grid();
  double const mm = unit::millimetre, length = units.metres();
  std::string const assumed = units.assumed(), undefined = units.undefined();
  FieldPlace place;
  place.units = {{"length", named(units.length)},
                 {"length_m", undefined.empty() ? nlohmann::json(length) : nlohmann::json(nullptr)},
                 {"assumed", named(assumed)},
                 {"unknown", named(undefined)},
                 {"values", named(units.values)}};
  Vec3d extent{};
  for (int axis = 0; axis < 3; ++axis) {
    extent[axis] = grid.spacing[axis] * length / mm * (grid.nodes[static_cast<std::size_t>(axis)] - 1);
  }
  place.extent_mm = {extent.x, extent.y, extent.z};
  place.text = fmt::format("{}, so the field is {:.6g} x {:.6g} x {:.6g} mm wide unless spacing_mm is given; values {}",
                           assumed.empty() ? "lengths are in " + units.length : assumed, extent.x, extent.y, extent.z,
                           units.values.empty() ? "name no unit" : "are in " + units.values);
  if (!undefined.empty()) {
    place.text = fmt::format("{}, so that spacing_mm must be given; values {}", undefined,
                             units.values.empty() ? "name no unit" : "are in " + units.values);
  }
  if (!assumed.empty()) place.warning = assumed + "; if that is wrong, give medium.field.spacing_mm";
  if (setup.empty()) return place;

  Setup const whole = with_field(setup, source, path, dataset, axes);
  if (whole.medium.field.spacing) place.warning.clear();
  FieldCoverage const seen = field_coverage(file_bounds(whole.medium), whole);
  place.coverage = {{"share", seen.share}, {"view_mm", {seen.view.x / mm, seen.view.y / mm}}, {"setup", setup}};
  place.text += fmt::format("; it fills {:.3g} % of the {:.4g} x {:.4g} mm that {} sees there", 100 * seen.share,
                            seen.view.x / mm, seen.view.y / mm, setup);
  if (std::string const warning = seen.warning(); !warning.empty()) place.text += "; " + warning;
  return place;
}

}  // namespace gladstone
