#include "render/medium/field_volume.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/fields/field_file.h"

namespace gladstone::inline medium {
namespace {

std::unique_ptr<FieldSource> open_file(FieldSetup const& field) {
  return open_field(field.file, field.dataset, 1, field.axes);
}

/// Returns the grid of a file's field in world coordinates. @throws DataError if it does not suit the setup
RegularGrid world_grid(FieldSetup const& field, FieldSource const& source) {
  RegularGrid grid = source.grid();
  if (field.extrude && grid.nodes[2] != 1) {
    throw DataError(
        ErrorCode::wrong_shape, field.file,
        fmt::format("{} has {} planes along z (extrude = true needs a single plane); set medium.field.extrude = false",
                    source.name(), grid.nodes[2]));
  }
  if (!field.extrude && grid.nodes[2] < 2) {
    throw DataError(ErrorCode::wrong_shape, field.file,
                    fmt::format("{} is a single plane (a volume needs at least two); set "
                                "medium.field.extrude = true to stack it over thickness_mm",
                                source.name()));
  }
  if (grid.nodes[0] < 2 || grid.nodes[1] < 2) {
    bool const plane = std::count(grid.nodes.begin(), grid.nodes.end(), 1) == 1;
    throw DataError(ErrorCode::wrong_shape, field.file,
                    fmt::format("{} has {} x {} nodes across x and y (at least 2 x 2 are needed){}", source.name(),
                                grid.nodes[0], grid.nodes[1],
                                plane && field.axes.empty() ? "; name the axes of the plane in the order of "
                                                              "the file: medium.field.axes = \"yx\""
                                                            : ""));
  }
  std::string const undefined = source.units().undefined();
  if (!field.spacing && !undefined.empty()) {
    throw DataError(ErrorCode::undetermined, field.file, undefined + "; give medium.field.spacing_mm");
  }
  grid.spacing = field.spacing ? *field.spacing : grid.spacing * source.units().metres();
  grid.periodic = field.periodic;
  if (field.extrude) grid.periodic[2] = false;
  for (int axis = 0; axis < 3; ++axis) {
    double const span = grid.spacing[axis] * (grid.nodes[static_cast<std::size_t>(axis)] - 1);
    grid.origin[axis] = field.center[axis] - span / 2;
  }
  return grid;
}

/// Returns a warning about units of length that were assumed; nullopt if they are known or the setup gives the spacing.
std::optional<Warning> assumed_lengths(FieldSetup const& field, FieldSource const& source, RegularGrid const& grid) {
  std::string const assumed = field.spacing ? "" : source.units().assumed();
  if (assumed.empty()) return {};
  double const mm = unit::millimetre;
  return Warning{
      WarningCode::assumed, "medium.field.file",
      fmt::format(
          "of {} in {} {} (the field is {:.4g} x {:.4g} mm wide); if that is wrong, give medium.field.spacing_mm",
          source.name(), field.file, assumed, grid.spacing.x * (grid.nodes[0] - 1) / mm,
          grid.spacing.y * (grid.nodes[1] - 1) / mm)};
}

/// Returns the notes of a file as warnings about the key that names it.
Warnings notes_of_file(FieldSetup const& field, FieldSource& source) {
  Warnings warnings = source.notes();
  for (Warning& note : warnings) note = {note.code, "medium.field.file", field.file + ": " + to_string(note)};
  return warnings;
}

/// Returns the factor from file values to kg/m^3 or to dimensionless numbers: the setup's if given, else that of the
/// unit in the file.
ValueFactor value_factor(FieldSetup const& field, FieldUnits const& units) {
  if (field.scale) return {*field.scale, ""};
  return units.value_factor(field.quantity == FieldQuantity::density ? dimension_of_density : dimension_of_numbers);
}

/// Returns a warning if a file contains n itself with so few bits that n - 1 is inaccurate.
/// @param scale      factor applied to the values in the file
/// @param low, high  smallest and largest refractivity
std::optional<Warning> lost_digits(FieldSetup const& field, FieldSource const& source, double scale, double low,
                                   double high) {
  int const bits = source.significant_bits();
  if (field.quantity != FieldQuantity::refractive_index || bits > std::numeric_limits<float>::digits) return {};
  double const largest = (1 + high) / std::abs(scale);
  double const step = std::abs(scale) * std::ldexp(1.0, std::ilogb(largest) + 1 - bits);
  return Warning{
      WarningCode::low_accuracy, "medium.field.quantity",
      fmt::format("{} of {} stores refractive indices with {} bits, so that n - 1 is resolved in steps of only {:.2g}, "
                  "{:.2g} % of its range in this field (the lost digits cannot be recovered, and gradients are noisy); "
                  "write the file as refractivity (n - 1) or density, or in double precision",
                  source.name(), field.file, bits, step, 100 * step / std::max(high - low, step))};
}

/// Returns a warning if the values suggest another quantity or unit. They do if all of them differ
/// from the ambient value by more than a factor of 100, which is implausible for gas flows at one pressure, or if
/// densities look like refractive indices.
/// @param scale      factor applied to the values in the file
/// @param low, high  smallest and largest refractivity
std::optional<Warning> unlikely_range(MediumSetup const& setup, std::string const& name, double scale, double low,
                                      double high) {
  FieldSetup const& field = setup.field;
  double const ambient = setup.ambient_refractivity();
  if (!(ambient > 0) || low < 0) return {};
  constexpr double factor = 100;
  bool const density = field.quantity == FieldQuantity::density;
  double const unit = density ? setup.gladstone_dale : 1.0;  // refractivity per unit of the values
  std::string likely;
  // gases have 1e-5 < n - 1 < 2e-3, so that densities all within 0.2 % of 1 may be refractive indices
  bool const index = density && scale == 1.0 && low > (1 + 1e-5) * unit && high < (1 + 2e-3) * unit;
  if (index) {
    likely = "these would be refractive indices of a gas; if they are, set quantity = \"refractive_index\"";
  } else if (high < ambient / factor) {
    // Among the interpretations within a factor of ten of the ambient value, suggest the closest one.
    auto const decades_off = [&](double ratio) {
      bool const fits = high * ratio > ambient / 10 && low * ratio < ambient * 10;
      return fits ? std::abs(std::log10(0.5 * (low + high) * ratio / ambient)) : HUGE_VAL;
    };
    double const as_refractivity = density ? decades_off(1 / unit) : HUGE_VAL, in_grams = decades_off(1e3);
    if (as_refractivity < in_grams) {
      likely = "as refractivities n - 1 they would fit; if they are, set quantity = \"refractivity\"";
    } else if (in_grams < HUGE_VAL) {
      likely = fmt::format("{} they would fit; if {}, set scale = {:g}",
                           density && scale == 1.0 ? "in g/cm^3" : "a thousand times as large",
                           density && scale == 1.0 ? "they are" : "their unit is so", 1000 * scale);
    }
  } else if (low > factor * ambient) {
    bool const as_density = !density && low * setup.gladstone_dale < 10 * ambient;
    likely = as_density ? "as densities in kg/m^3 they would fit; if they are, set quantity = \"density\"" : "";
  } else {
    return {};
  }
  if (likely.empty()) likely = "check medium.field.quantity, scale and medium.ambient_density_kg_m3";
  return Warning{WarningCode::implausible, "medium.field.quantity",
                 fmt::format("the values of {} in {} reach from {:.6g} to {:.6g}{}, where the ambient has {:.4g}{}; {}",
                             name, field.file, low / unit, high / unit, density ? " kg/m^3" : " (n - 1)",
                             ambient / unit, density ? " kg/m^3" : "", likely)};
}

double finest_cell(FieldSetup const& field, RegularGrid const& grid) {
  double const across = std::min(grid.spacing.x, grid.spacing.y);
  return field.extrude ? across : std::min(across, grid.spacing.z);
}

/// Returns the upper limit of the step size in a file's field [m]: two cells, since within a cell a spline is smooth; a
/// quarter of a cell of a trilinear field, which is not; a quarter of the thickness of an extruded spline, which does
/// not vary along Z.
double coarsest_step_in(MediumSetup const& setup, RegularGrid const& grid) {
  bool const spline = setup.interpolation == FieldInterpolation::cubic_bspline;
  if (spline && setup.field.extrude) return setup.thickness / 4;
  return (spline ? 2 : 0.25) * finest_cell(setup.field, grid);
}

/// Returns the region of a file's field [m].
Bounds<double> field_bounds(MediumSetup const& setup, RegularGrid const& grid) {
  Bounds<double> box = grid_bounds(grid);
  if (setup.field.extrude) {
    box.low.z = setup.field.center.z - setup.thickness / 2;
    box.high.z = setup.field.center.z + setup.thickness / 2;
  }
  return box;
}

template <class Stored, int Dimensions>
BuiltMedium build_grid(MediumSetup const& setup, RegularGrid const& grid, FieldSource& source) {
  using Volume = RefractiveIndexVolume<Stored>;
  FieldSetup const& field = setup.field;
  bool const spline = setup.interpolation == FieldInterpolation::cubic_bspline;
  ValueFactor const factor = value_factor(field, source.units());
  double const scale = factor.factor * (field.quantity == FieldQuantity::density ? setup.gladstone_dale : 1.0);
  double const shift = field.quantity == FieldQuantity::refractive_index ? -1.0 : 0.0;
  auto const volume = std::make_shared<Volume const>(
      grid, spline ? Volume::Interpolation::cubic_bspline : Volume::Interpolation::trilinear, scale, shift,
      [&](int first, int count, std::span<double> out) { source.read_planes(first, count, out); });
  if (!is_plausible_refractivity(volume->lowest()) || !is_plausible_refractivity(volume->highest())) {
    throw DataError(ErrorCode::out_of_range, field.file,
                    fmt::format("{} gives refractive indices from {:.6g} to {:.6g} (no medium has such "
                                "indices); check medium.field.quantity and scale",
                                source.name(), 1 + volume->lowest(), 1 + volume->highest()));
  }
  BuiltMedium built;
  built.warnings = notes_of_file(field, source);
  if (!factor.warning.empty()) {
    built.warnings.push_back({WarningCode::assumed, "medium.field.file",
                              fmt::format("{}: {}; if that is wrong, give medium.field.scale or medium.field.quantity",
                                          field.file, factor.warning)});
  }
  auto const odd = unlikely_range(setup, source.name(), factor.factor, volume->lowest(), volume->highest());
  auto const lost = lost_digits(field, source, factor.factor, volume->lowest(), volume->highest());
  for (auto const& warning : {odd, lost, assumed_lengths(field, source, grid)}) {
    if (warning) built.warnings.push_back(*warning);
  }
  built.lowest = volume->lowest();
  built.highest = volume->highest();
  Bounds<double> const box = field_bounds(setup, grid);
  if (spline) {
    built.view = volume->template view<double, CubicBspline, Dimensions>(box.low.z, box.high.z);
  } else {
    built.view = volume->template view<double, Linear, Dimensions>(box.low.z, box.high.z);
  }
  built.owner = volume;
  built.grid = grid;
  built.steepest = volume->steepest();
  built.finest = finest_cell(field, grid);
  built.coarsest_step = coarsest_step_in(setup, grid);
  return built;
}

/// Builds a medium without a grid: none, or a field in closed form.
BuiltMedium build_without_grid(MediumSetup const& setup) {
  BuiltMedium built;
  built.finest = setup.thickness;
  if (setup.field.kind == FieldKind::closed_form) {
    std::visit(
        [&built](auto const& form) {
          built.view = form;
          built.finest = form.finest();
          built.steepest = form.steepest();
        },
        make_closed_form(setup));
  }
  built.coarsest_step = std::min(built.finest, setup.thickness / 4);
  built.owner = std::make_shared<FieldSetup const>(setup.field);
  return built;
}

}  // namespace

std::size_t medium_bytes_needed(MediumSetup const& setup) {
  if (setup.field.kind != FieldKind::file) return 0;
  auto const source = open_file(setup.field);
  RegularGrid const& grid = source->grid();
  return grid.nodes[2] == 1 ? RefractiveIndexVolume<double>::bytes_needed(grid)
                            : RefractiveIndexVolume<float>::bytes_needed(grid);
}

Warnings header_warnings(MediumSetup const& setup) {
  FieldSetup const& field = setup.field;
  if (field.kind != FieldKind::file) return {};
  auto const source = open_file(field);
  Warnings warnings = notes_of_file(field, *source);
  if (auto const assumed = assumed_lengths(field, *source, world_grid(field, *source))) warnings.push_back(*assumed);
  return warnings;
}

Bounds<double> file_bounds(MediumSetup const& setup) {
  return field_bounds(setup, world_grid(setup.field, *open_file(setup.field)));
}

double steps_across(MediumSetup const& setup) {
  if (setup.field.kind != FieldKind::file) return setup.thickness / build_without_grid(setup).coarsest_step;
  RegularGrid const grid = world_grid(setup.field, *open_file(setup.field));
  Bounds<double> const box = field_bounds(setup, grid);
  return (box.high.z - box.low.z) / coarsest_step_in(setup, grid);
}

double finest_length(MediumSetup const& setup) {
  if (setup.field.kind != FieldKind::file) return build_without_grid(setup).finest;
  return finest_cell(setup.field, world_grid(setup.field, *open_file(setup.field)));
}

BuiltMedium build_medium(MediumSetup const& setup) {
  if (setup.field.kind != FieldKind::file) return build_without_grid(setup);
  auto const source = open_file(setup.field);
  RegularGrid const grid = world_grid(setup.field, *source);
  return setup.field.extrude ? build_grid<double, 2>(setup, grid, *source) : build_grid<float, 3>(setup, grid, *source);
}

}  // namespace gladstone::inline medium
