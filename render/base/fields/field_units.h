#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gladstone {

/// Units of a field as stated in its file.
struct FieldUnits {
  bool spaced = false;  ///< the file has coordinates or spacings; otherwise nodes are one unit apart
  std::string length;   ///< unit of length as written; empty: not stated
  std::string values;   ///< unit of the values as written; empty: not stated
  std::string unknown;  ///< message about an axis whose spacing is undefined in the file; empty: none

  /// Size of the unit of length [m]; 1 mm if it is not stated or not recognised.
  double metres() const;
  /// Describes the assumption made about lengths, "lengths name no unit and are taken as mm"; empty if none was
  /// necessary.
  std::string assumed() const;
};

/// Removes white space and NUL characters from both ends of a text (Fortran programs pad units with blanks).
std::string trimmed(std::string_view text);

/// Returns the factor that converts lengths from one unit to another: 1 for equal names, nullopt if a name is not
/// recognised.
std::optional<double> unit_ratio(std::string_view from, std::string_view to);

/// Returns the size of a unit of length [m] from its name ("m", "metres", "mm", "um", "micron", "inch" ...); 0 if it is
/// not recognised.
double length_unit(std::string_view name);

}  // namespace gladstone
