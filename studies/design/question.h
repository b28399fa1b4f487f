#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "render/setup/setup_node.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline design {

/// Design variables.
enum class Choice { focal_length, f_number, z_a, z_d, dot_diameter };
inline constexpr std::size_t choice_count = 5;

/// Keys and unit of a design variable.
struct ChoiceKey {
  char const* path;       ///< path of the setup's key
  char const* limit;      ///< key in [limits]: the last part of the path
  char const* inventory;  ///< key of the available values in [inventory]; null: none
  double unit;            ///< value of the key's unit in SI
};
inline constexpr std::array<ChoiceKey, choice_count> choice_keys{{
    {"lens.focal_length_mm", "focal_length_mm", "focal_lengths_mm", 1e-3},
    {"lens.f_number", "f_number", "f_numbers", 1},
    {"geometry.z_a_mm", "z_a_mm", nullptr, 1e-3},
    {"geometry.z_d_mm", "z_d_mm", nullptr, 1e-3},
    {"target.dot_diameter_mm", "dot_diameter_mm", nullptr, 1e-3},
}};
constexpr ChoiceKey const& choice_key(Choice choice) { return choice_keys[static_cast<std::size_t>(choice)]; }

/// Quantity to be minimized.
enum class Objective { gradient_min, resolution, uncertainty, z_total };
inline constexpr std::array<char const*, 4> objective_words{"gradient_min", "resolution", "uncertainty", "z_total"};
/// Unit, key and scale (value of the unit in SI) of each objective in the output.
inline constexpr std::array<char const*, 4> objective_units{"kg/m^4", "mm", "px", "mm"};
inline constexpr std::array<char const*, 4> objective_keys{"gradient_min_kg_m4", "resolution_mm", "random_px",
                                                           "z_total_mm"};
inline constexpr std::array<double, 4> objective_scales{1, 1e-3, 1, 1e-3};

struct Bound;

/// A constraint with its limit, in SI.
struct Limit {
  Bound const* bound;
  double value;
};

/// Requirements on a design.
struct Requirements {
  Objective objective = Objective::gradient_min;
  std::vector<Limit> limits;  ///< limits given by the user, in the order of requirements()
};

/// A design variable with its admissible values or interval, in SI.
struct FreeChoice {
  Choice choice;
  std::vector<double> values;  ///< discrete values; empty: any value from low to high
  double low = 0, high = 0;
};

/// A camera of the inventory: contents of [camera] in its file.
struct InventoryCamera {
  std::string file;
  SetupNode table;
};

/// A requested design: tables [requirements], [limits], [inventory] and [free] of a setup.
struct DesignQuestion {
  Requirements requirements;
  std::vector<FreeChoice> free;
  std::vector<InventoryCamera> cameras;  ///< cameras to choose from; empty: the setup's camera
  std::vector<std::string> lenses;       ///< absolute paths of prescription files, in addition to the thin lenses
};

/// Reads the requested design; adds every problem to the document at its key.
/// @return nullopt without a table [requirements]
std::optional<DesignQuestion> read_design_question(SetupDocument& document);

}  // namespace gladstone::inline design
