#include "studies/case/usual_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "render/setup/setup_node.h"

namespace gladstone::inline cases {
namespace {

/// Unit in which a number may have been given by mistake.
struct OtherUnit {
  char const* name;
  double factor;  ///< size of that unit in the key's unit
};

constexpr std::array of_mm{OtherUnit{"m", 1e3}, OtherUnit{"um", 1e-3}, OtherUnit{"cm", 10.0},
                           OtherUnit{"inches", 25.4}};
constexpr std::array of_um{OtherUnit{"mm", 1e3}, OtherUnit{"m", 1e6}, OtherUnit{"nm", 1e-3}};
constexpr std::array of_nm{OtherUnit{"um", 1e3}, OtherUnit{"mm", 1e6}, OtherUnit{"m", 1e9}};
constexpr std::array of_us{OtherUnit{"s", 1e6}, OtherUnit{"ms", 1e3}, OtherUnit{"ns", 1e-3}};
constexpr std::array of_mj{OtherUnit{"J", 1e3}, OtherUnit{"uJ", 1e-3}};
constexpr std::array of_gladstone_dale{OtherUnit{"cm^3/g", 1e-3}};
constexpr std::array of_density{OtherUnit{"g/cm^3", 1e3}};
constexpr std::array of_speed{OtherUnit{"mm/s", 1e-3}, OtherUnit{"km/s", 1e3}};
constexpr std::array of_viscosity{OtherUnit{"mPa s", 1e-3}, OtherUnit{"uPa s", 1e-6}};
constexpr std::array of_share{OtherUnit{"%", 0.01}};
constexpr std::array<OtherUnit, 0> of_count{};

/// Range of a key's values in laboratories, from microscopes to wind tunnels.
struct UsualRange {
  std::array<char const*, 3> path;  ///< names of the tables, then the key; null: no further name
  double low, high;                 ///< limits in the unit of the key
  char const* unit;
  /// other units in which the number may have been given, the most likely one first
  std::span<OtherUnit const> others;
};

constexpr std::array usual_ranges{
    UsualRange{{"camera", "pixel_pitch_um"}, 0.5, 100, "um", of_um},
    UsualRange{{"camera", "noise", "full_well_e"}, 50, 1e7, "electrons", of_count},
    UsualRange{{"camera", "noise", "read_noise_e"}, 0.01, 2000, "electrons", of_count},
    UsualRange{{"camera", "noise", "quantum_efficiency"}, 0.01, 1, "", of_share},
    UsualRange{{"lens", "focal_length_mm"}, 2, 2e4, "mm", of_mm},
    UsualRange{{"lens", "focus_distance_mm"}, 5, 1e6, "mm", of_mm},
    UsualRange{{"geometry", "z_a_mm"}, 5, 2e5, "mm", of_mm},
    UsualRange{{"geometry", "z_d_mm"}, 1, 2e5, "mm", of_mm},
    UsualRange{{"medium", "wavelength_nm"}, 230, 1690, "nm", of_nm},
    UsualRange{{"medium", "gladstone_dale"}, 5e-5, 2e-3, "m^3/kg", of_gladstone_dale},
    UsualRange{{"medium", "ambient_density_kg_m3"}, 2e-3, 2e3, "kg/m^3", of_density},
    UsualRange{{"medium", "thickness_mm"}, 0.05, 1e5, "mm", of_mm},
    UsualRange{{"target", "dot_diameter_mm"}, 0.003, 100, "mm", of_mm},
    UsualRange{{"target", "extent_mm"}, 0.5, 1e5, "mm", of_mm},
    UsualRange{{"calibration", "dot_diameter_mm"}, 0.003, 100, "mm", of_mm},
    UsualRange{{"calibration", "spacing_mm"}, 0.01, 1e3, "mm", of_mm},
    UsualRange{{"particles", "diameter_um"}, 0.02, 2000, "um", of_um},
    UsualRange{{"particles", "diameter_um", "median_um"}, 0.02, 2000, "um", of_um},
    UsualRange{{"particles", "diameter_um", "mean_um"}, 0.02, 2000, "um", of_um},
    UsualRange{{"particles", "volume_mm"}, 0.02, 1e4, "mm", of_mm},
    UsualRange{{"particles", "density_kg_m3"}, 0.1, 2.5e4, "kg/m^3", of_density},
    UsualRange{{"particles", "viscosity_pa_s"}, 1e-6, 1e2, "Pa s", of_viscosity},
    UsualRange{{"laser", "wavelength_nm"}, 200, 2000, "nm", of_nm},
    UsualRange{{"laser", "pulse_energy_mj"}, 1e-3, 1e4, "mJ", of_mj},
    UsualRange{{"laser", "thickness_mm"}, 0.02, 500, "mm", of_mm},
    UsualRange{{"laser", "height_mm"}, 0.5, 1e4, "mm", of_mm},
    UsualRange{{"flow", "dt_us"}, 0.005, 1e6, "us", of_us},
    UsualRange{{"flow", "velocity_m_s"}, 1e-6, 1e4, "m/s", of_speed},
};

/// Returns the element of an array with a single table; otherwise the node itself.
SetupNode const* only(SetupNode const* node) {
  bool const one = node && node->kind == SetupNode::Kind::array && node->elements.size() == 1;
  return one && node->elements[0].kind == SetupNode::Kind::table ? &node->elements[0] : node;
}

/// Returns the number of a key, or the numbers of an array.
std::vector<double> numbers_of(SetupNode const& node) {
  if (node.is_number()) return {node.as_double()};
  std::vector<double> numbers;
  for (SetupNode const& element : node.elements) {
    if (element.is_number()) numbers.push_back(element.as_double());
  }
  return numbers;
}

std::string with_unit(double value, char const* unit) {
  return fmt::format("{:.6g}{}{}", value, *unit ? " " : "", unit);
}

/// Returns a text about a value outside its key's range; empty for values inside.
std::string unusual_value(UsualRange const& usual, double value) {
  double const size = std::abs(value);
  auto const inside = [&usual](double x) { return x >= usual.low && x <= usual.high; };
  if (size == 0 || !std::isfinite(size) || inside(size)) return "";
  std::string text = fmt::format("{} is outside the usual range, {:.6g} to {}", with_unit(value, usual.unit), usual.low,
                                 with_unit(usual.high, usual.unit));
  auto const likely = std::find_if(usual.others.begin(), usual.others.end(),
                                   [&](OtherUnit const& other) { return inside(size * other.factor); });
  if (likely == usual.others.end()) return text + "; check its unit";
  return text + fmt::format("; is it in {}? {:.6g} {} are {}", likely->name, value, likely->name,
                            with_unit(value * likely->factor, usual.unit));
}

}  // namespace

Warnings unusual_values(SetupDocument& document) {
  Warnings warnings;
  for (UsualRange const& usual : usual_ranges) {
    std::vector<std::string> path;
    for (char const* const name : usual.path) {
      if (name) path.emplace_back(name);
    }
    SetupNode const* node = document.find({path.front()});
    for (std::size_t i = 1; node && i < path.size(); ++i) {
      SetupNode const* const table = only(node);
      node = table->kind == SetupNode::Kind::table ? table->find(path[i]) : nullptr;
    }
    if (!node) continue;
    std::string text;
    for (double const value : numbers_of(*node)) {
      if (text.empty()) text = unusual_value(usual, value);
    }
    if (text.empty()) continue;
    std::vector<SetupTable> tables = document.root().tables(path.front());
    if (tables.size() != 1) continue;
    SetupTable table = tables.front();
    for (std::size_t i = 1; i + 1 < path.size(); ++i) table = table.table(path[i]);
    warnings.push_back({WarningCode::implausible, table.where(path.back()),
                        fmt::format("{}.{} = {}", path.front(), fmt::join(path.begin() + 1, path.end(), "."), text)});
  }
  return warnings;
}

}  // namespace gladstone::inline cases
