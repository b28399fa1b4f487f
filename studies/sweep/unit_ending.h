#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace gladstone {

/// How a name carries its unit: "_mm", "mm". An empty ending: the name does without.
struct UnitEnding {
  std::string_view ending;
  std::string_view unit;
};

/// The unit that a key of the setup or a measure ends in. Nothing: a pure number, or no number at all.
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
  if (name.ends_with("gladstone_dale")) return UnitEnding{"", "m^3/kg"};  // the constant has no unit in its name
  return std::nullopt;
}

}  // namespace gladstone
