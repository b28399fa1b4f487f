#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace gladstone::inline sweep {

/// Unit suffix of a name and the unit that it denotes: "_mm", "mm". Names without suffix have an empty ending.
struct UnitEnding {
  std::string_view ending;
  std::string_view unit;
};

/// Returns the unit suffix of a setup key or measure, or nullopt if it is dimensionless or not a number.
constexpr std::optional<UnitEnding> unit_ending(std::string_view name) {
  constexpr std::array<UnitEnding, 11> endings{{{"_px2", "px^2"},
                                                {"_px", "px"},
                                                {"_mm", "mm"},
                                                {"_um", "um"},
                                                {"_nm", "nm"},
                                                {"_deg", "deg"},
                                                {"_rad", "rad"},
                                                {"_kg_m3", "kg/m^3"},
                                                {"_kg_m4", "kg/m^4"},
                                                {"_e", "e"},
                                                {"_dn", "DN"}}};
  for (UnitEnding const& known : endings) {
    if (name.ends_with(known.ending)) return known;
  }
  if (name.ends_with("gladstone_dale")) return UnitEnding{"", "m^3/kg"};  // the constant's name contains no unit
  return std::nullopt;
}

}  // namespace gladstone::inline sweep
