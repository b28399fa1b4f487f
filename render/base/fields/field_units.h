#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace gladstone {

/// What a field's file says of the units of its numbers.
struct FieldUnits {
  bool spaced = false;  ///< the file gives coordinates or spacings; without them nodes stand one unit apart
  std::string length;   ///< unit of those as written; empty: none is named
  std::string values;   ///< unit of the values as written; empty: none is named
  std::string unknown;  ///< axis whose spacing the file declares unknown, for messages; empty: none

  /// Size of the unit of length [m]; a millimetre where none is named, or one that is not known.
  double metres() const;
  /// What had to be assumed of lengths: "lengths name no unit and are taken as mm"; empty where nothing had to.
  std::string assumed() const;
};

/// Text without blanks at its ends: a Fortran program pads its units with them.
std::string trimmed(std::string_view text);

/// Factor from lengths in one unit to lengths in another: 1 of equal names; nullopt where either name is not known.
std::optional<double> unit_ratio(std::string_view from, std::string_view to);

/// Size of a unit of length [m] by its usual names ("m", "metres", "mm", "um", "micron", "inch" ...); 0: not known.
double length_unit(std::string_view name);

}  // namespace gladstone
