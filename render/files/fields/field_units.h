#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "render/base/warning.h"
#include "render/files/fields/field_axes.h"

namespace gladstone::inline files {

/// Exponents of mass, length and time in the dimension of a physical quantity.
struct Dimension {
  int mass = 0, length = 0, time = 0;
  friend bool operator==(Dimension const&, Dimension const&) = default;
};
inline constexpr Dimension dimension_of_length{0, 1, 0}, dimension_of_density{1, -3, 0},
    dimension_of_velocity{0, 1, -1}, dimension_of_numbers{0, 0, 0};

/// Factor that converts the values of a file to SI, and a warning if their unit is not used.
struct ValueFactor {
  double factor = 1;
  std::string warning;  ///< warning that the unit is not used; empty: no unit is stated, or it was converted
};

/// Units of a field as stated in its file.
struct FieldUnits {
  bool spaced = false;        ///< true: the file has coordinates or spacings; otherwise nodes are one unit apart
  std::string length;         ///< unit of length as written; empty: not stated
  std::string values;         ///< unit of the values as written; empty: not stated
  std::string unknown;        ///< message about an axis whose spacing is undefined in the file; empty: none
  std::string unspaced = {};  ///< world axes of several nodes whose spacing the file does not state: "xz"

  /// Size of the unit of length [m]; 1 mm if it is not stated or not recognised.
  double metres() const;
  /// Describes the assumption made about lengths, "lengths have no unit in the file and are taken as mm"; empty if none
  /// was necessary.
  std::string assumed() const;
  /// Describes why the spacing is undefined, "lengths are in \"furlong\", which is not a known unit of length"; empty
  /// if it is defined. The user must then give the spacing.
  std::string undefined() const;
  /// Returns the factor from the stated unit of the values to the SI unit of a dimension (kg/m^3, m/s, 1); 1 with a
  /// warning if the unit is not recognised or has another dimension.
  ValueFactor value_factor(Dimension const& dimension) const;
};

/// Returns false for texts that name no unit: "", "1", "-", "none", "dimensionless" ...
bool states_unit(std::string_view text);

/// Ending of a name that states a unit, and that unit: "_kg_m3", "kg/m^3".
struct UnitSuffix {
  std::string_view ending, unit;
};
/// Returns the unit suffix of a name of a density or velocity ("rho_kg_m3", "u_m_s"), in upper or lower case; empty if
/// there is none.
UnitSuffix unit_suffix(std::string_view name);

/// Returns the size of a unit in SI units from a product of names with exponents ("mm", "kg m-3", "g/cm^3", "m s**-1",
/// "[kg/l]"), in upper or lower case; nullopt if it is not recognised or has another dimension.
std::optional<double> unit_size(std::string_view text, Dimension const& dimension);

/// Returns the size of a unit of length [m] from its name ("m", "metres", "mm", "um", "micron", "inch" ...); 0 if it is
/// not recognised.
double length_unit(std::string_view name);

/// Converts all axes to the unit of the first axis that states one. An axis that states none is taken to be in that
/// unit, with a note; an unknown unit among known ones is reported by FieldUnits::unknown.
/// @param unit_of  unit of each axis as written; nullopt: the axis has no spacing in the file
/// @param units    receives `length` and, if a unit cannot be converted, `unknown`
/// @param notes    receives the note
void convert_lengths(StoredAxes& axes, std::array<std::optional<std::string>, 3> const& unit_of, FieldUnits& units,
                     Warnings& notes);

}  // namespace gladstone::inline files
